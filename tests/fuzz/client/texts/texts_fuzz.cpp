// SPDX-License-Identifier: Apache-2.0
//
// Any text as what a client reads: a script of limn-load, a server's address, a catalogue, a
// camera, a path, an orbit. What was read must survive being written.
#include "client/load/script.h"
#include "client/net/server_url.h"
#include "client/pose/camera_file.h"
#include "client/pose/orbit.h"
#include "client/pose/recorded_path.h"
#include "client/view/catalogue.h"

#include <cmath>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto script = limn::load::parseScript(text, "/nonexistent");
      !script && script.error().message.empty()) {
    std::abort();
  }
  if (const auto url = limn::parseServerUrl(text)) {
    if (!limn::parseServerUrl(url->text())) std::abort();
  }
  if (const auto camera = limn::parseCamera(text)) {
    if (!limn::parseCamera(limn::cameraFileJson(*camera))) std::abort();
  }
  if (const auto path = limn::parseRecordedPath(text)) {
    const auto again = limn::parseRecordedPath(limn::recordedPathJson(*path));
    if (!again || again->size() != path->size()) std::abort();
    const double middle = limn::durationOf(*path) / 2;
    if (!std::isfinite(limn::cameraAt(*path, middle).eye.x)) std::abort();
  }
  static_cast<void>(limn::parseOrbit(text));
  static_cast<void>(limn::parseCatalogue(text));
  return 0;
}
