// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <optional>

namespace limn {

/// Where the line p + t·d meets triangle abc [Möller, Trumbore 1997]: t, or nothing.
inline std::optional<double> meets(
    const glm::dvec3& a,
    const glm::dvec3& b,
    const glm::dvec3& c,
    const glm::dvec3& p,
    const glm::dvec3& d) {
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ac = c - a;
  const glm::dvec3 q = glm::cross(d, ac);
  const double det = glm::dot(ab, q);
  if (det == 0.0) return std::nullopt;
  const glm::dvec3 ap = p - a;
  const double u = glm::dot(ap, q) / det;
  if (u < 0.0 || u > 1.0) return std::nullopt;
  const glm::dvec3 r = glm::cross(ap, ab);
  const double v = glm::dot(d, r) / det;
  if (v < 0.0 || u + v > 1.0) return std::nullopt;
  return glm::dot(ac, r) / det;
}

}  // namespace limn
