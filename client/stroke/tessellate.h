// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/spine.h"
#include "client/stroke/spine_samples.h"
#include "client/stroke/style.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// A corner of a stroke's strip. Nine floats, read by the stroke shader in this order.
struct StrokeVertex {
  glm::vec2 position{0.0F};  // pixels, origin top left
  float across = 0.0F;       // −1 … 1 from the left to the right edge of the strip
  float sample = 0.0F;       // coordinate of the spine there among SpineSamples
  float visibleU = 0.0F;     // repeats of the visible texture since the line's start
  float hiddenU = 0.0F;      // the same of the hidden one
  float visibleFade = 1.0F;  // opacity of the visible parts
  float hiddenFade = 1.0F;
  float margin = 0.0F;  // half the strip's width here, in pixels
};

static_assert(sizeof(StrokeVertex) == 9 * sizeof(float));

struct StrokeMesh {
  std::vector<StrokeVertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles, either orientation
};

/// Turns spines into strips of constant width in pixels. Neighbouring segments share their corner
/// vertices (a mitre); where the line turns too sharply for that, the segments end square and a fan
/// closes the outer side. Strips may overlap there, so they are to be drawn with "maximum"
/// blending. Textures run by arc length; a closed line's repeat is fitted so that it closes without
/// a seam. widthPx: of the ink. Cost: O(points).
[[nodiscard]] StrokeMesh tessellate(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const SpineSamples& samples,
    const PolylineSet& lines,
    const StrokeStyle& style,
    float widthPx);

}  // namespace limn
