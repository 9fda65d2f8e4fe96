// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// The mesh as an index buffer of triangles with adjacency (GL_TRIANGLES_ADJACENCY), six a face:
/// corner 0, the corner that the neighbour across edge 01 has opposite to it, corner 1, the one
/// across 12, corner 2, the one across 20. Faces whose edges lie at the same two places, turned
/// oppositely, are neighbours even where the mesh does not join them (vertices split for attributes
/// or for manifoldness), unless there are more than two. Across an edge without neighbour stands
/// the face's own third corner: a face folded back onto itself, for which a border is a silhouette.
/// positions: one a vertex. Threads: reentrant. Cost: O(faces + borders · log borders).
[[nodiscard]] std::vector<std::uint32_t> trianglesWithAdjacency(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions);

/// Each edge once, as four indices: from, to, the opposite corner of the face that has it in this
/// direction, the opposite corner of its neighbour (or the same again at a border). adjacency: of
/// the mesh, as trianglesWithAdjacency() makes it; edges that it joins by place occur twice, once
/// from each face, so `twins` leaves no edge out.
[[nodiscard]] std::vector<std::uint32_t> edgesWithOpposites(
    const HalfEdgeMesh& mesh,
    std::span<const std::uint32_t> adjacency);

}  // namespace limn
