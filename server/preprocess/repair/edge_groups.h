// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn::repair {

/// The half-edges of a triangle soup, grouped by undirected edge. Half-edge 3f + k runs from corner
/// k of triangle f to the next. Groups are ordered by their smaller, then larger vertex; half-edges
/// within one by number.
class EdgeGroups {
 public:
  /// triangles: every corner < vertexCount, corners of each distinct. Cost: O(F log valence).
  EdgeGroups(std::uint32_t vertexCount, std::span<const glm::uvec3> triangles);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(begin_.size() - 1); }

  [[nodiscard]] std::span<const HalfEdgeId> operator[](std::uint32_t group) const {
    return {halfEdges_.data() + begin_[group], begin_[group + 1] - begin_[group]};
  }

  /// Follows triangles that were flipped (y and z exchanged): their half-edges change numbers, not
  /// edges. flipped: one a triangle.
  void renumberFlipped(std::span<const std::uint8_t> flipped);

 private:
  std::vector<HalfEdgeId> halfEdges_;
  std::vector<std::uint32_t> begin_;
};

/// Origin and target of half-edge h.
[[nodiscard]] inline std::uint32_t originOf(std::span<const glm::uvec3> triangles, HalfEdgeId h) {
  return triangles[h / 3][static_cast<int>(h % 3)];
}

[[nodiscard]] inline std::uint32_t targetOf(std::span<const glm::uvec3> triangles, HalfEdgeId h) {
  return triangles[h / 3][static_cast<int>((h % 3 + 1) % 3)];
}

}  // namespace limn::repair
