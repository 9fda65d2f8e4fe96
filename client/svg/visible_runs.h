// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_scene.h"
#include "client/stroke/polyline.h"
#include "client/stroke/resolved_visibility.h"
#include "client/stroke/spine.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// A stretch of a spine that is all visible or all hidden, as it is drawn.
struct VisibleRun {
  std::vector<glm::vec2> points;  // pixels; a closed run's first point is not repeated
  std::uint32_t spine = 0;
  bool visible = true;
  bool closed = false;
};

struct RunOptions {
  /// Shorter changes are specks: dense meshes flip from edge to edge. They take on what is around
  /// them, the shortest first.
  float shortestPx = 5.5F;
};

/// Cuts spines where their visibility changes. Every spine's runs cover it whole and share their
/// cuts' points; a loop that changes nowhere stays a loop. spines and arcs: of `lines` in `scene`;
/// resolved: of the same. Cost: O(points).
[[nodiscard]] std::vector<VisibleRun> cutAtVisibility(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const PolylineSet& lines,
    const ResolvedLines& resolved,
    const LineScene& scene,
    const RunOptions& options = {});

}  // namespace limn
