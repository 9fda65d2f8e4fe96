// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/triangle_mesh.h"

#include <algorithm>
#include <cmath>

namespace limn {

BoundingSphere boundingSphere(const Grid& grid, std::span<const glm::ivec3> positions) {
  if (positions.empty()) return {grid.origin, grid.step};
  glm::ivec3 low = positions[0];
  glm::ivec3 high = positions[0];
  for (const glm::ivec3& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 center = 0.5 * (glm::dvec3(low) + glm::dvec3(high));
  double squared = 0.0;
  for (const glm::ivec3& p : positions) {
    const glm::dvec3 d = glm::dvec3(p) - center;
    squared = std::max(squared, glm::dot(d, d));
  }
  return {grid.origin + grid.step * center, grid.step * std::max(std::sqrt(squared), 0.5)};
}

}  // namespace limn
