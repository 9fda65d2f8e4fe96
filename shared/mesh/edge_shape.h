// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/integer_vectors.h"
#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <span>

/// What the surface around an edge does, which decides whether its contour can be seen.
namespace limn {

/// In grid units.
[[nodiscard]] inline glm::dvec3
edgeMiddle(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions, HalfEdgeId h) {
  return 0.5 * (glm::dvec3(positions[mesh.origin(h)]) + glm::dvec3(positions[mesh.target(h)]));
}

/// Whether the two faces at half-edge h, which has a twin, bend inwards. Exact for any coordinates
/// up to kMaxGridCoordinate. Cost: O(1).
[[nodiscard]] inline bool
isConcave(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions, HalfEdgeId h) {
  const glm::i64vec3 a(positions[mesh.origin(h)]);
  const glm::i64vec3 ab = glm::i64vec3(positions[mesh.target(h)]) - a;
  const glm::i64vec3 ac = glm::i64vec3(positions[mesh.origin(HalfEdgeMesh::prev(h))]) - a;
  const glm::i64vec3 ad =
      glm::i64vec3(positions[mesh.origin(HalfEdgeMesh::prev(mesh.twin(h)))]) - a;
  return dotExact(crossExact(ab, ac), ad) > 0;
}

/// Whether a face around either end of half-edge h, which has a twin, but for its own two, is in
/// front of its middle [MollerTrumbore97]. towardEye: from the middle to the eye, any length.
/// Cost: O(valence).
[[nodiscard]] bool isCoveredNearby(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    HalfEdgeId h,
    const glm::dvec3& towardEye);

/// Whether the face of half-edge h is in front of a line from the vertex that h leaves, close to
/// it, where the face is the cone of its two edges. along, towardEye: as isCoveredAtStart(). Cost:
/// O(1).
[[nodiscard]] bool coversAtStart(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    HalfEdgeId h,
    const glm::dvec3& along,
    const glm::dvec3& towardEye);

/// Whether a face around the vertex that half-edge `out` leaves is in front of a line from there,
/// close to it; edge: whose two faces do not count. along: the line's direction; towardEye: from
/// the vertex to the eye, any length. Cost: O(valence).
[[nodiscard]] bool isCoveredAtStart(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    HalfEdgeId out,
    HalfEdgeId edge,
    const glm::dvec3& along,
    const glm::dvec3& towardEye);

}  // namespace limn
