// SPDX-License-Identifier: Apache-2.0
#include "client/apps/picture_flags.h"

#include "client/apps/flag_values.h"

#include <CLI/CLI.hpp>

namespace limn {

void PictureFlags::addTo(CLI::App& app, const Help& help) {
  app.add_option("--camera", camera_, help.camera);
  app.add_option("--size", size_, help.size);
  app.add_option("--gl", gl_, help.gl);
}

Result<PictureChoice> PictureFlags::parse() const {
  PictureChoice choice;
  if (!camera_.empty()) {
    const auto orbit = parseOrbit(camera_);
    if (!orbit) return tl::unexpected(orbit.error());
    choice.orbit = *orbit;
  }
  if (!size_.empty()) {
    const auto size = parseSize(size_);
    if (!size) return tl::unexpected(size.error());
    choice.size = *size;
  }
  const auto gl = parseGlBackend(gl_);
  if (!gl) return tl::unexpected(gl.error());
  choice.gl = *gl;
  return choice;
}

}  // namespace limn
