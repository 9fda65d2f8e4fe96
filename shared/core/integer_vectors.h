// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstdint>

/// Exact predicates on grid coordinates. glm's cross and dot take floats only.
namespace limn {

__extension__ using Int128 = __int128;

/// Exact for coordinates below 2^31.
[[nodiscard]] inline glm::i64vec3 crossExact(const glm::i64vec3& a, const glm::i64vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Exact for any coordinates below 2^62.
[[nodiscard]] inline Int128 dotExact(const glm::i64vec3& a, const glm::i64vec3& b) {
  return Int128{a.x} * b.x + Int128{a.y} * b.y + Int128{a.z} * b.z;
}

}  // namespace limn
