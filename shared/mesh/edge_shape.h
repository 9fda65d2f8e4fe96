// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <span>

namespace limn {

/// Whether the two faces at half-edge h, which has a twin, bend inwards. Exact: grid coordinates
/// have at most 20 bits, so the triple product fits 64. Cost: O(1).
[[nodiscard]] inline bool
isConcave(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions, HalfEdgeId h) {
  using Wide = glm::i64vec3;
  const Wide a(positions[mesh.origin(h)]);
  const Wide ab = Wide(positions[mesh.target(h)]) - a;
  const Wide ac = Wide(positions[mesh.origin(HalfEdgeMesh::prev(h))]) - a;
  const Wide ad = Wide(positions[mesh.origin(HalfEdgeMesh::prev(mesh.twin(h)))]) - a;
  const Wide n(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
  return n.x * ad.x + n.y * ad.y + n.z * ad.z > 0;
}

}  // namespace limn
