// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

namespace limn {

/// A cone of directions: all unit vectors within acos(cosHalf) of `axis`.
struct NormalCone {
  glm::dvec3 axis{0.0, 0.0, 1.0};  // unit
  double cosHalf = -1.0;           // −1: every direction

  [[nodiscard]] bool contains(const glm::dvec3& unit) const {
    return glm::dot(axis, unit) >= cosHalf;
  }
};

/// The smallest cone around two, or every direction where it would have to be wider than a half
/// space. Rounding is to the safe side. Takes square roots only: the same on every platform.
[[nodiscard]] NormalCone mergedCone(const NormalCone& a, const NormalCone& b);

}  // namespace limn
