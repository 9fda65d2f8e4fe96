// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// The closed mesh that a hull is made from, under edge collapses. Slots of vertices and faces are
/// those of the input; dead faces have origins kNone.
class HullMesh {
 public:
  /// mesh: closed, without borders, as HalfEdgeMesh::build made it.
  HullMesh(HalfEdgeMesh mesh, std::vector<glm::ivec3> positions);

  /// What a collapse did: `removed` went into `kept`, between the corners left and right.
  struct Collapse {
    std::uint32_t kept = kNone;
    std::uint32_t removed = kNone;
    std::uint32_t left = kNone;   // around `kept` counter-clockwise come left, what was `removed`'s
    std::uint32_t right = kNone;  // fan, right
    glm::ivec3 keptPosition{0};   // before the collapse
    glm::ivec3 removedPosition{0};
  };

  /// The link condition [Dey99, "Topology preserving edge contraction"] for the edge of h.
  /// Cost: O(valence of both).
  [[nodiscard]] bool canCollapse(HalfEdgeId h) const;

  /// Collapses the edge of h, whose origin stays and moves to `position`. Needs canCollapse(h).
  Collapse collapse(HalfEdgeId h, const glm::ivec3& position);

  /// Faces with a corner at either end of h's edge, those of the edge first.
  void facesAround(HalfEdgeId h, std::vector<FaceId>& out) const;

  [[nodiscard]] const HalfEdgeMesh& links() const { return links_; }

  [[nodiscard]] const std::vector<glm::ivec3>& positions() const { return positions_; }

  [[nodiscard]] const glm::ivec3& corner(FaceId f, std::uint32_t k) const {
    return positions_[links_.origins[3 * f + k]];
  }

  [[nodiscard]] bool isAlive(FaceId f) const { return links_.origins[3 * f] != kNone; }

  [[nodiscard]] std::uint32_t aliveFaces() const { return aliveFaces_; }

  [[nodiscard]] std::uint32_t valence(std::uint32_t v) const;

 private:
  HalfEdgeMesh links_;
  std::vector<glm::ivec3> positions_;
  std::uint32_t aliveFaces_ = 0;
};

}  // namespace limn
