// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_fade.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/spine.h"

#include <vector>

namespace limn {

/// Joins contours over short gaps, as an illustrator draws on: where one goes out of sight at a
/// cusp and another of the same fold comes out ahead of it, in the direction in which the first
/// went, appends a spine from one cusp to the other (SpineSet::Spine::isBridge), at most reachPx
/// long. Of `lines` in `scene`, before any smoothing. Threads: reentrant. Cost: O(points + cusps ·
/// cusps near in x).
void bridgeCusps(
    const PolylineSet& lines,
    const LineScene& scene,
    float reachPx,
    SpineSet& spines,
    std::vector<LineFade>& fades);

}  // namespace limn
