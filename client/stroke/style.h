// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <glm/glm.hpp>

#include <string>
#include <string_view>

namespace limn {

/// One of the two looks of a line: a picture of a stroke, repeated along it.
struct StrokeTexture {
  std::string file;  // a PNG beside the style; its alpha (or, without alpha, its darkness) is ink
  float lengthPx = 200.0F;  // of one repeat, at the style's own width
  glm::vec3 color{0.0F};    // of the ink, sRGB 0 … 1
  float opacity = 1.0F;
};

/// A texture set, read from `style.toml`: how lines look, visible and hidden [Mohr13 §3.4].
struct StrokeStyle {
  float widthPx = 2.5F;       // of the ink
  float body = 0.6F;          // share of the texture's height that is ink; the rest is for wobble
  float taperPx = 0.0F;       // open ends thin out over this length
  float overshootPx = 0.0F;   // open ends run on by this much
  float pool = 0.0F;          // open ends swell by this share of the width
  float creaseWidth = 0.75F;  // of creases and seams, as a share of widthPx
  float smoothPx = 1.0F;      // standard deviation of smoothing along the line; 0: none
  float fadeBelowPx = 6.0F;   // lines whose extent is below this fade away, from twice this on
  float fadeHiddenBelowPx = 16.0F;  // the same for their hidden parts
  float creaseFade = 2.0F;  // both of these limits are this many times higher for creases and seams
  StrokeTexture visible;
  StrokeTexture hidden;
  glm::vec3 paper{1.0F};  // sRGB 0 … 1
  float grain = 0.0F;     // how much the paper's tooth shows through the ink, 0 … 1
};

/// Parses a style. Unknown keys are refused, so that a typing mistake does not pass as a default.
/// Errors: kCorrupt, with the key or line.
[[nodiscard]] Result<StrokeStyle> parseStyle(std::string_view toml);

/// The style with its textures' repeats that many times as long.
[[nodiscard]] StrokeStyle withTextureSize(StrokeStyle style, double factor);

/// The style with every length that many times as long: for a picture that many times as large.
[[nodiscard]] StrokeStyle enlarged(StrokeStyle style, float factor);

/// `#rrggbb` as sRGB 0 … 1. Errors: kInvalidArgument.
[[nodiscard]] Result<glm::vec3> parseColor(std::string_view text);

}  // namespace limn
