// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/hulls/crossing_tree.h"
#include "server/preprocess/hulls/hull_mesh.h"
#include "server/preprocess/hulls/triangle_crossing.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// Tells which collapses would let faces cross. Exact.
class CrossingGuard {
 public:
  explicit CrossingGuard(const HullMesh& mesh) : tree_(mesh) {}

  /// Whether the edge of h, collapsed into `position`, would make faces meet that share no corner
  /// there, where those around the edge meet none yet. A mesh that crosses itself to begin with
  /// may go on doing so where it does. Cost: some 10 µs.
  [[nodiscard]] bool wouldCross(const HullMesh& mesh, HalfEdgeId h, const glm::ivec3& position);

  /// Call after each collapse, with the vertex that is left.
  void collapsed(const HullMesh& mesh, std::uint32_t kept);

 private:
  struct Face {
    hull::Corners corners{};
    hull::Triangle triangle{};
    GridBox box;
  };

  [[nodiscard]] static Face faceOf(const HullMesh& mesh, FaceId f);
  [[nodiscard]] bool meetAny(const HullMesh& mesh, std::uint32_t a, std::uint32_t b);

  CrossingTree tree_;
  std::vector<FaceId> around_;
  std::vector<FaceId> found_;
  std::vector<Face> faces_;
};

}  // namespace limn
