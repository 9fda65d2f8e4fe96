// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <array>

namespace limn {

/// The six planes of a view volume, inward: inside where dot(xyz, p) + w ≥ 0; xyz is unit.
struct Frustum {
  std::array<glm::dvec4, 6> planes;  // left, right, bottom, top, near, far

  /// From clipFromWorld, OpenGL clip space [GribbHartmann01]. Planes are in the frame of "world".
  [[nodiscard]] static Frustum fromMatrix(const glm::dmat4& clipFromWorld);

  [[nodiscard]] bool contains(const glm::dvec3& point) const;
  /// False only when the sphere is wholly outside; conservative at corners.
  [[nodiscard]] bool mayIntersect(const glm::dvec3& center, double radius) const;
};

}  // namespace limn
