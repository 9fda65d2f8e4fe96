// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/pose/orbit.h"
#include "client/render/gl_context.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace limn {

/// From where, how large and with what pictures are drawn; what was not said is unset.
struct PictureChoice {
  std::optional<Orbit> orbit;
  std::optional<Viewport> size;
  GlBackend gl = GlBackend::kEgl;
};

/// --camera, --size and --gl, as flags of a command.
class PictureFlags {
 public:
  /// What they mean to the command, for --help.
  struct Help {
    const char* camera;
    const char* size;
    const char* gl;
  };

  void addTo(CLI::App& app, const Help& help);

  /// Errors: kInvalidArgument.
  [[nodiscard]] Result<PictureChoice> parse() const;

 private:
  std::string camera_, size_, gl_ = "egl";
};

}  // namespace limn
