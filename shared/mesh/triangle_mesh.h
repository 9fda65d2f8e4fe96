// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"
#include "shared/mesh/vertex_attributes.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// The integer grid that all positions of a model live on. Model position = origin + step · grid.
struct Grid {
  glm::dvec3 origin{0.0};  // minimum of the referenced vertices of the input
  double step = 1.0;       // longest side of the box / (2^bits − 1); > 0
  int bits = 14;           // 11 to 18: prepared positions are 0 … 2^bits − 1 along each axis

  [[nodiscard]] glm::dvec3 toModel(const glm::ivec3& p) const {  // grid units to model units
    return origin + step * glm::dvec3(p);
  }

  [[nodiscard]] glm::dvec3 fromModel(const glm::dvec3& p) const { return (p - origin) / step; }
};

/// No grid coordinate is larger in magnitude (grids have 18 bits at most), so that products of a
/// few of them fit 64 bits. What comes from outside is checked against it.
inline constexpr std::int32_t kMaxGridCoordinate = 1 << 20;

[[nodiscard]] inline bool isOnGrid(const glm::ivec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < -kMaxGridCoordinate || p[axis] > kMaxGridCoordinate) return false;
  }
  return true;
}

/// A triangle mesh on a grid: flat arrays, no connectivity. Triangles are counter-clockwise seen
/// from outside. Nothing is checked here: HalfEdgeMesh::build() says whether it is a manifold.
struct TriangleMesh {
  Grid grid;
  std::vector<glm::ivec3> positions;  // a vertex each, grid units, isOnGrid()
  std::vector<glm::uvec3> triangles;  // a face each: three different indices into `positions`
  AttributeArrays attributes{};       // each array empty, or an entry a vertex
};

/// About the box's centre, to the farthest position; model units, radius ≥ step / 2. Cost: O(n).
[[nodiscard]] BoundingSphere boundingSphere(
    const Grid& grid,
    std::span<const glm::ivec3> positions);

}  // namespace limn
