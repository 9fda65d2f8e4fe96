// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstdint>

// glm's cross and dot take floats only. On grid differences (19 bits) a cross product has 39 bits
// and a triple product 59: exact.
namespace limn::repair {

[[nodiscard]] inline glm::i64vec3 crossExact(const glm::i64vec3& a, const glm::i64vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

[[nodiscard]] inline std::int64_t dotExact(const glm::i64vec3& a, const glm::i64vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

}  // namespace limn::repair
