// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/surface_segment.h"
#include "shared/silhouette/curvature.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

enum class RidgeKind : std::uint8_t { kRidge, kValley };

/// Lines along which a surface bends most sharply: maxima of the larger principal curvature across
/// its own direction where that is positive (ridges), minima where it is negative (valleys)
/// [Ohtake04]. The same from every view. Nodes are edgeNode(), and past all half-edges a face's
/// index where three lines meet inside it. threshold: the weakest curvature that shows, times the
/// surface's feature size (rtsc's limit); strength is ½ at twice this.
/// Threads: reentrant. Cost: O(faces).
[[nodiscard]] std::vector<SurfaceSegment> findRidges(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const SurfaceCurvature& curvature,
    RidgeKind kind,
    float threshold = 0.1F);

}  // namespace limn
