// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/integer_vectors.h"

#include <glm/glm.hpp>

/// Exact arithmetic on hull grid positions. Coordinates have 22 bits and a sign at most
/// (kMaxHullCoordinate), so a difference has 23, a cross product 47, a triple product 72.
namespace limn::hull {

/// Twice the area of a triangle times its unit normal.
[[nodiscard]] inline glm::i64vec3
areaNormal(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& c) {
  return crossExact(glm::i64vec3(b) - glm::i64vec3(a), glm::i64vec3(c) - glm::i64vec3(a));
}

/// Six times the volume of the tetrahedron (a, b, c, p): positive where p is on the side that the
/// triangle's normal points to, 0 on its plane.
[[nodiscard]] inline Int128
volume6(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& c, const glm::ivec3& p) {
  return dotExact(areaNormal(a, b, c), glm::i64vec3(p) - glm::i64vec3(a));
}

[[nodiscard]] inline int sign(Int128 value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

}  // namespace limn::hull
