// SPDX-License-Identifier: Apache-2.0
// Based on: E. G. Gilbert, D. W. Johnson, S. S. Keerthi, "A fast procedure for computing the
// distance between complex objects in three-dimensional space", IEEE J. Robotics and Automation
// 4(2), 1988: a simplex of the points, the closest point of it, the point farthest against that
// direction, and so on. Deviation: the simplex's closest point is the best of those of its faces
// that have the newest corner, tried one by one instead of by Johnson's recursion.
#include "shared/core/closest_point.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace limn {
namespace {

constexpr int kMostSteps = 64;

/// Corners of a simplex and the point of its hull closest to the origin.
struct Simplex {
  std::array<glm::dvec3, 4> corners{};
  std::uint32_t count = 0;
  glm::dvec3 closest{0.0};
};

/// The point of the span of some corners closest to the origin; `inside`: it is within the simplex
/// that they make.
struct Foot {
  glm::dvec3 point{0.0};
  bool inside = false;
};

Foot footOf(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 edge = b - a;
  const double square = glm::dot(edge, edge);
  const double t = -glm::dot(a, edge);
  return {a + (t / square) * edge, t > 0.0 && t < square};
}

Foot footOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double square = glm::dot(normal, normal);
  if (!(square > 0.0)) return {};
  const glm::dvec3 p = glm::dot(a, normal) / square * normal;
  const bool inside = glm::dot(normal, glm::cross(b - a, p - a)) > 0.0 &&
                      glm::dot(normal, glm::cross(c - b, p - b)) > 0.0 &&
                      glm::dot(normal, glm::cross(a - c, p - c)) > 0.0;
  return {p, inside};
}

/// Whether a tetrahedron of some volume holds the origin.
Foot footOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  const auto volume = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
    return glm::dot(p, glm::cross(q, r));
  };
  const double whole = glm::dot(b - a, glm::cross(c - a, d - a));
  return {
      glm::dvec3(0.0),
      whole * volume(b, c, d) > 0.0 && whole * volume(a, c, d) < 0.0 &&
          whole * volume(a, b, d) > 0.0 && whole * volume(a, b, c) < 0.0};
}

Foot footOf(const Simplex& simplex, std::uint32_t subset) {
  std::array<glm::dvec3, 4> at{};
  std::size_t n = 0;
  for (std::uint32_t i = 0; i < simplex.count; ++i) {
    if ((subset >> i & 1U) != 0) at[n++] = simplex.corners[i];
  }
  switch (n) {
    case 1:
      return {at[0], true};
    case 2:
      return footOf(at[0], at[1]);
    case 3:
      return footOf(at[0], at[1], at[2]);
    default:
      return footOf(at[0], at[1], at[2], at[3]);
  }
}

/// Adds a corner and keeps those that the closest point needs.
void extend(const glm::dvec3& corner, Simplex& simplex) {
  simplex.corners[simplex.count++] = corner;
  const std::uint32_t newest = 1U << (simplex.count - 1);
  Foot best;
  std::uint32_t bestSubset = 0;
  for (std::uint32_t subset = newest; subset < 2 * newest; ++subset) {
    const Foot foot = footOf(simplex, subset);
    if (!foot.inside) continue;
    if (best.inside && glm::dot(foot.point, foot.point) >= glm::dot(best.point, best.point))
      continue;
    best = foot;
    bestSubset = subset;
  }
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < simplex.count; ++i) {
    if ((bestSubset >> i & 1U) != 0) simplex.corners[kept++] = simplex.corners[i];
  }
  simplex.count = kept;
  simplex.closest = best.point;
}

}  // namespace

glm::dvec3 closestPointOfHull(std::span<const glm::dvec3> points, double accuracy) {
  Simplex simplex;
  extend(points.front(), simplex);
  for (int step = 0; step < kMostSteps; ++step) {
    const glm::dvec3 at = simplex.closest;
    const double square = glm::dot(at, at);
    if (square <= accuracy * accuracy) return glm::dvec3(0.0);
    double least = square;
    const glm::dvec3* farthest = nullptr;
    for (const glm::dvec3& p : points) {
      const double along = glm::dot(at, p);
      if (along >= least) continue;
      least = along;
      farthest = &p;
    }
    if (farthest == nullptr || square - least <= accuracy) return at;
    extend(*farthest, simplex);
    // Rounding can keep it from getting closer.
    if (!(glm::dot(simplex.closest, simplex.closest) < square)) return at;
    if (simplex.count == 4) return glm::dvec3(0.0);
  }
  return simplex.closest;
}

}  // namespace limn
