// SPDX-License-Identifier: Apache-2.0
#include "shared/progressive/map_normal.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr double kHalf = 63.0;
constexpr double kZero = 64.0;

/// Turns the lower half of the octahedron outwards about its square, and back.
glm::dvec2 folded(const glm::dvec2& p) {
  return {
      (1.0 - std::abs(p.y)) * (p.x < 0.0 ? -1.0 : 1.0),
      (1.0 - std::abs(p.x)) * (p.y < 0.0 ? -1.0 : 1.0)};
}

std::uint8_t toByte(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(kZero + kHalf * value), 1L, 127L));
}

}  // namespace

glm::dmat3
mapFrame(const glm::dvec3& corner0, const glm::dvec3& corner1, const glm::dvec3& corner2) {
  const glm::dvec3 edge = corner1 - corner0;
  const glm::dvec3 normal = glm::cross(edge, corner2 - corner0);
  const double length = glm::length(normal);
  if (!(length > 0.0)) return glm::dmat3(1.0);
  const glm::dvec3 z = normal / length;
  const glm::dvec3 x = glm::normalize(edge);
  return {x, glm::cross(z, x), z};
}

std::array<std::uint8_t, 2> encodeMapNormal(const glm::dmat3& frame, const glm::dvec3& normal) {
  const glm::dvec3 n = glm::transpose(frame) * normal;
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0.0)) return {static_cast<std::uint8_t>(kZero), static_cast<std::uint8_t>(kZero)};
  glm::dvec2 p = glm::dvec2(n) / sum;
  if (n.z < 0.0) p = folded(p);
  return {toByte(p.x), toByte(p.y)};
}

glm::dvec3 decodeMapNormal(const glm::dmat3& frame, const std::array<std::uint8_t, 2>& code) {
  glm::dvec2 p((code[0] - kZero) / kHalf, (code[1] - kZero) / kHalf);
  const double z = 1.0 - std::abs(p.x) - std::abs(p.y);
  if (z < 0.0) p = folded(p);
  return frame * glm::normalize(glm::dvec3(p, z));
}

}  // namespace limn
