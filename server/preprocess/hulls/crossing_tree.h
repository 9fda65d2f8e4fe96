// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/hulls/hull_mesh.h"

#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

struct GridBox {
  glm::ivec3 low{INT32_MAX};
  glm::ivec3 high{INT32_MIN};

  void add(const glm::ivec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }

  void add(const GridBox& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }

  [[nodiscard]] bool meets(const GridBox& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
           other.low.y <= high.y && low.z <= other.high.z && other.low.z <= high.z;
  }

  [[nodiscard]] bool contains(const GridBox& other) const {
    return glm::all(glm::lessThanEqual(low, other.low)) &&
           glm::all(glm::greaterThanEqual(high, other.high));
  }
};

/// Boxes around the faces of a mesh that changes, to find what may cross. A face keeps its leaf;
/// boxes on the way up only grow, and the tree is built anew whenever half of the faces have gone.
class CrossingTree {
 public:
  explicit CrossingTree(const HullMesh& mesh) { build(mesh); }

  /// A living face has moved. Cost: O(log faces).
  void update(const HullMesh& mesh, FaceId f);
  /// Rebuilds when it is time to. Call after collapses.
  void maintain(const HullMesh& mesh);

  /// Faces whose boxes meet `box`; dead ones may be among them.
  void find(const GridBox& box, std::vector<FaceId>& out) const;

 private:
  void build(const HullMesh& mesh);

  std::uint32_t leaves_ = 0;  // a power of two; node i has children 2i and 2i + 1, the root is 1
  std::uint32_t faces_ = 0;   // when built
  std::vector<GridBox> boxes_;
  std::vector<FaceId> faceOfLeaf_;
  std::vector<std::uint32_t> leafOfFace_;
};

[[nodiscard]] GridBox boxOf(const HullMesh& mesh, FaceId f);

}  // namespace limn
