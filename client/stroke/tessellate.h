// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/brush.h"
#include "client/stroke/line_fade.h"
#include "client/stroke/parameters.h"
#include "client/stroke/spine.h"
#include "client/stroke/style.h"
#include "client/stroke/visibility/spine_samples.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// A corner of a stroke's strip. Nine floats, read by the stroke shader in this order.
struct StrokeVertex {
  glm::vec2 position{0.0F};  // pixels, origin top left
  float across = 0.0F;       // −1 … 1 from the left to the right edge of the strip
  float sample = 0.0F;       // coordinate of the spine there among SpineSamples
  float visibleU = 0.0F;     // repeats of the visible texture since the line's start
  float hiddenU = 0.0F;      // the same of the hidden one
  float visibleFade = 1.0F;  // of the visible parts: thinner, then paler (line_density.h)
  float hiddenFade = 1.0F;   // opacity of the hidden parts
  float margin = 0.0F;       // half the strip's width here, in pixels
};

static_assert(sizeof(StrokeVertex) == 9 * sizeof(float));

struct StrokeMesh {
  std::vector<StrokeVertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles, either orientation
};

/// Spines and what was worked out about them, all parallel.
struct StrokeSpines {
  const SpineSet& spines;
  const SpineArcs& arcs;
  std::span<const LineFade> fades;
  const SpineSamples& samples;
  const SpineParameters& parameters;
  std::span<const float> widths = {};  // by spine point, a factor on the stroke's width; empty: 1
};

/// One repeat of the style's textures, in pixels of parameter, for an ink of widthPx: the longer of
/// the two; the other divides it a whole number of times, so that both close together on a loop.
[[nodiscard]] float texturePeriod(const StrokeStyle& style, float widthPx);

/// How often one of the style's textures repeats in a period.
[[nodiscard]] float repeatsAPeriod(const StrokeStyle& style, const StrokeTexture& texture);

/// Turns spines into strips. Points that a straight strip passes within a fraction of a pixel are
/// left out. Neighbouring segments share their corner vertices (a mitre); where the line turns too
/// sharply for that, the segments end square and a fan closes the outer side. Strips may overlap
/// there, so they are to be drawn with "maximum" blending. A brush leads the strip off its spine;
/// it keeps the spine's visibility. widthPx: of the ink.
/// `out` is filled anew; its memory is used again. Cost: O(points).
void tessellate(
    const StrokeSpines& strokes,
    const StrokeStyle& style,
    float widthPx,
    const Brush& brush,
    StrokeMesh& out);

}  // namespace limn
