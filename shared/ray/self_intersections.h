// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"
#include "shared/mesh/surface_segment.h"

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace limn {

/// Where faces of a mesh pass through one another: the lines along which parts of a machine that
/// were modelled one by one enter each other. A segment a pair of crossing faces, on one of the
/// two; a node is a place where an edge pierces a face, and two pairs share it, so that segments
/// chain. Faces that share a corner do not cross; where parts touch flush there may be lines along
/// the edges of the contact. positions: one a vertex, grid units, within kMaxGridCoordinate.
/// Threads: reentrant. Cost: O(edges · log faces), about 1 µs an edge.
[[nodiscard]] std::vector<SurfaceSegment> findSelfIntersections(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions);

}  // namespace limn
