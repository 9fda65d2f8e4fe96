// SPDX-License-Identifier: Apache-2.0
#include "shared/view/frustum.h"

namespace limn {

Frustum Frustum::fromMatrix(const glm::dmat4& clipFromWorld) {
  const glm::dmat4 rows = glm::transpose(clipFromWorld);
  Frustum frustum;
  for (int axis = 0; axis < 3; ++axis) {
    frustum.planes[static_cast<std::size_t>(2 * axis)] = rows[3] + rows[axis];
    frustum.planes[static_cast<std::size_t>(2 * axis) + 1] = rows[3] - rows[axis];
  }
  for (glm::dvec4& plane : frustum.planes)
    plane /= glm::length(glm::dvec3(plane));
  return frustum;
}

bool Frustum::contains(const glm::dvec3& point) const {
  return mayIntersect(point, 0.0);
}

bool Frustum::mayIntersect(const glm::dvec3& center, double radius) const {
  for (const glm::dvec4& plane : planes) {
    if (glm::dot(glm::dvec3(plane), center) + plane.w < -radius) return false;
  }
  return true;
}

}  // namespace limn
