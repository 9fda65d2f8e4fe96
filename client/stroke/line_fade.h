// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_scene.h"
#include "client/stroke/spine.h"
#include "client/stroke/style.h"

#include <cstdint>
#include <vector>

namespace limn {

/// How much of a line is to be seen: 1 at full size, 0 where it is too small to be more than a
/// speck.
struct LineFade {
  float visible = 1.0F;
  float hidden = 1.0F;
};

/// Fades of every spine by its extent (where visible: with those that continue it, unless they make
/// a scribble), a smooth ramp from the style's limit to twice as much; small ones that take a
/// larger outline's place do not fade, if larger than a stroke is wide. The limits are at most a
/// share of the whole drawing's extent, so that a small picture of a model is not an empty one.
/// Parallel to SpineSet::spines. Cost: O(spines · log spines + length of outlines in pixels).
void fadeLines(
    const SpineSet& spines,
    const StrokeStyle& style,
    const LineScene& scene,
    std::vector<LineFade>& fades);

/// Leaves out spines of which nothing is to be seen, and their fades. Cost: O(points).
void dropFaded(SpineSet& spines, std::vector<LineFade>& fades);

}  // namespace limn
