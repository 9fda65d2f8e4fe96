// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/spine.h"

namespace limn {

/// Takes swallowtails out of smooth silhouettes: where a contour runs to a cusp, back behind its
/// own surface and on from a second cusp, its two visible branches cross or touch, and what sticks
/// out beyond is a hook, what lies between a break. Those go that reach at most reachPx from where
/// the branches meet, so that one goes on as the other. Of `lines` in `scene`, before any
/// smoothing. Cost: O(points · points within reach).
void cutFoldBacks(
    const PolylineSet& lines,
    const LineScene& scene,
    float reachPx,
    SpineSet& spines);

}  // namespace limn
