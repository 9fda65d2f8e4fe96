// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/spine.h"
#include "client/stroke/visibility/resolved_visibility.h"
#include "client/stroke/visibility/spine_samples.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// A stretch of a spine that is all visible or all hidden, as it is drawn.
struct VisibleRun {
  std::vector<glm::vec2> points;  // pixels; a closed run's first point is not repeated
  std::uint32_t spine = 0;
  float arc = 0.0F;  // along the spine, where it begins
  bool visible = true;
  bool closed = false;
};

/// Cuts spines where their visibility changes; gaps and visible parts too short to be told from
/// what is right go as in the picture (closedGap and kShortRun in
/// client/stroke/visibility/visibility.h). Every spine's runs cover it whole and share their cuts'
/// points; a loop that changes nowhere stays a loop; a bridge is visible where what it joins is.
/// spines and arcs: of `lines` in `scene`; resolved: of the same; samples: of the spines, those of
/// contours that are nested in visible ones (NestedContours) count as hidden. Cost: O(points +
/// samples + bridges · runs).
[[nodiscard]] std::vector<VisibleRun> cutAtVisibility(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const PolylineSet& lines,
    const ResolvedLines& resolved,
    const LineScene& scene,
    const SpineSamples& samples,
    int closedGap);

}  // namespace limn
