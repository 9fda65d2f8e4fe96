// SPDX-License-Identifier: Apache-2.0
#include "client/render/draw_options.h"

#include "client/stroke/stroke_builder.h"

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
    ModeName{DrawMode::kImageEdges, "image-edges", false},
    ModeName{DrawMode::kGeometryShader, "geometry-shader", false},
    ModeName{DrawMode::kConditionalLines, "conditional-lines", false},
    ModeName{DrawMode::kBackWireframe, "image-precision:wireframe", false},
    ModeName{DrawMode::kBackTranslate, "image-precision:translate", false},
    ModeName{DrawMode::kBackZScale, "image-precision:z-scale", false},
    ModeName{DrawMode::kBackOffset, "image-precision:offset", false},
    ModeName{DrawMode::kBackFatten, "image-precision:fatten", false},
    ModeName{DrawMode::kBackCharcoal, "image-precision:charcoal", false},
    ModeName{DrawMode::kClip, "clip", true},
};

const ModeName& entryOf(DrawMode mode) {
  return *std::find_if(kModes.begin(), kModes.end(), [mode](const ModeName& entry) {
    return entry.mode == mode;
  });
}

}  // namespace

std::vector<DrawMode> allDrawModes() {
  std::vector<DrawMode> modes;
  for (const ModeName& entry : kModes)
    modes.push_back(entry.mode);
  return modes;
}

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

Result<FirstLayer> parseFirstLayer(std::string_view name) {
  if (name == "auto") return FirstLayer::kAuto;
  if (name == "winding") return FirstLayer::kWinding;
  if (name == "numbers") return FirstLayer::kNumbers;
  return fail(
      ErrorCode::kInvalidArgument,
      "the first layer cannot be found by '" + std::string(name) +
          "': use auto, winding or numbers");
}

Result<HiddenLines> parseHiddenLines(std::string_view name) {
  if (name == "style") return HiddenLines::kStyle;
  if (name == "off") return HiddenLines::kOff;
  if (name == "as-visible") return HiddenLines::kAsVisible;
  return fail(
      ErrorCode::kInvalidArgument,
      "hidden lines cannot be '" + std::string(name) + "': use style, off or as-visible");
}

float lineWidthPx(const RenderOptions& options, const StrokeStyle& style, const Camera& camera) {
  if (options.widthModelUnits) {
    const float px = widthInPixels(*options.widthModelUnits, camera, options.viewport);
    return std::clamp(px, 0.1F, 256.0F);
  }
  return static_cast<float>(options.pixelScale * options.widthPx.value_or(double{style.widthPx}));
}

float lineWidthFalloff(const RenderOptions& options) {
  return options.widthModelUnits ? 1.0F : static_cast<float>(options.widthFalloff);
}

}  // namespace limn
