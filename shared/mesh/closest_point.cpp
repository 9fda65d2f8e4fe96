// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/closest_point.h"

#include <algorithm>

namespace limn {
namespace {

glm::dvec3 closestOnSegment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  if (length2 == 0.0) return a;
  return a + std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) * along;
}

}  // namespace

glm::dvec3 closestPointOnTriangle(
    const glm::dvec3& p,
    const glm::dvec3& a,
    const glm::dvec3& b,
    const glm::dvec3& c) {
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double area2 = glm::dot(normal, normal);
  if (area2 > 0.0) {
    const double wa = glm::dot(glm::cross(b - p, c - p), normal);
    const double wb = glm::dot(glm::cross(c - p, a - p), normal);
    const double wc = glm::dot(glm::cross(a - p, b - p), normal);
    if (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) return p - normal * (glm::dot(p - a, normal) / area2);
  }
  // Outside all three edges' slab or degenerate: the closest of the edges' closest points.
  glm::dvec3 best = closestOnSegment(p, a, b);
  for (const glm::dvec3& q : {closestOnSegment(p, b, c), closestOnSegment(p, c, a)}) {
    if (glm::dot(q - p, q - p) < glm::dot(best - p, best - p)) best = q;
  }
  return best;
}

}  // namespace limn
