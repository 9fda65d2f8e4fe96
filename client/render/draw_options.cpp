// SPDX-License-Identifier: Apache-2.0
#include "client/render/draw_options.h"

#include <algorithm>
#include <array>

namespace limn {
namespace {

struct ModeName {
  DrawMode mode;
  std::string_view name;
  bool needsLines;
};

constexpr std::array kModes = {
    ModeName{DrawMode::kStrokes, "strokes", true},
    ModeName{DrawMode::kShaded, "shaded", false},
};

const ModeName& entryOf(DrawMode mode) {
  return *std::find_if(kModes.begin(), kModes.end(), [mode](const ModeName& entry) {
    return entry.mode == mode;
  });
}

}  // namespace

Result<DrawMode> parseDrawMode(std::string_view name) {
  std::string choices;
  for (const ModeName& entry : kModes) {
    if (entry.name == name) return entry.mode;
    choices += (choices.empty() ? "" : ", ") + std::string(entry.name);
  }
  return fail(
      ErrorCode::kInvalidArgument,
      "there is no way to draw called '" + std::string(name) + "': use one of " + choices);
}

std::string_view nameOf(DrawMode mode) {
  return entryOf(mode).name;
}

bool needsLines(DrawMode mode) {
  return entryOf(mode).needsLines;
}

Result<HiddenLines> parseHiddenLines(std::string_view name) {
  if (name == "style") return HiddenLines::kStyle;
  if (name == "off") return HiddenLines::kOff;
  if (name == "as-visible") return HiddenLines::kAsVisible;
  return fail(
      ErrorCode::kInvalidArgument,
      "hidden lines cannot be '" + std::string(name) + "': use style, off or as-visible");
}

}  // namespace limn
