// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/spine.h"

#include <vector>

namespace limn {

/// The arc-length parameter of strokes, by which textures and brushes run along them, in pixels.
/// Parallel to SpineSet::points: where the segment that starts there begins and ends. A segment
/// begins where the one before it ends, but for seams: there the texture starts anew.
struct SpineParameters {
  std::vector<float> from;
  std::vector<float> to;
};

/// Parameters from nothing but the frame itself: each line starts at its own place in the texture
/// (a hash of its first point), and a closed line's parameter is stretched to a whole number of
/// periods, where that is by little. periodPx: of the textures. Cost: O(points).
void freshParameters(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const PolylineSet& lines,
    float periodPx,
    SpineParameters& out);

}  // namespace limn
