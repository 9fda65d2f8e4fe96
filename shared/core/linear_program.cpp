// SPDX-License-Identifier: Apache-2.0
// Based on: R. Seidel, "Small-dimensional linear programming and convex hulls made easy", 1991:
// constraints are added one by one, in random order; one that the minimum so far breaks holds with
// equality at the new minimum, which is therefore found in one dimension less. The argument needs a
// unique minimum only, and so carries over from a linear goal to the distance from a point
// [Sharir92, "LP-type problems"].
#include "shared/core/linear_program.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace limn {
namespace {

/// How far outside a half-space a point may be: rounding of coordinates about 1 that were computed
/// from a point some 1e5 away.
constexpr double kSlack = 1e-10;
/// Squared sine of the angle below which two planes count as parallel.
constexpr double kParallel = 1e-20;

/// One dimension: the point origin + t · direction closest to the origin, if any.
std::optional<glm::dvec3> closestOnLine(
    std::span<const HalfSpace> constraints,
    const glm::dvec3& origin,
    const glm::dvec3& direction) {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  for (const HalfSpace& c : constraints) {
    const double slope = glm::dot(c.normal, direction);
    const double missing = c.offset - glm::dot(c.normal, origin);
    if (slope * slope < kParallel) {
      if (missing > kSlack) return std::nullopt;
    } else if (slope > 0.0) {
      low = std::max(low, missing / slope);
    } else {
      high = std::min(high, missing / slope);
    }
  }
  if (low > high + kSlack) return std::nullopt;
  return origin + std::clamp(0.0, std::min(low, high), high) * direction;
}

/// Two dimensions: the point of `plane` closest to `goal`, which lies on it.
std::optional<glm::dvec3> closestOnPlane(
    std::span<const HalfSpace> constraints,
    const HalfSpace& plane,
    const glm::dvec3& goal) {
  glm::dvec3 best = goal;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const HalfSpace& c = constraints[i];
    if (glm::dot(c.normal, best) >= c.offset - kSlack) continue;
    const glm::dvec3 inPlane = c.normal - glm::dot(c.normal, plane.normal) * plane.normal;
    const double length2 = glm::dot(inPlane, inPlane);
    if (length2 < kParallel) return std::nullopt;
    const glm::dvec3 onLine = goal + (c.offset - glm::dot(c.normal, goal)) / length2 * inPlane;
    const glm::dvec3 direction = glm::normalize(glm::cross(plane.normal, c.normal));
    const auto found = closestOnLine(constraints.first(i), onLine, direction);
    if (!found) return std::nullopt;
    best = *found;
  }
  return best;
}

}  // namespace

std::optional<glm::dvec3>
solveLinearProgram(std::span<HalfSpace> constraints, const LinearGoal& goal, Rng& order) {
  for (std::size_t i = constraints.size(); i > 1; --i) {
    std::swap(constraints[i - 1], constraints[order.below(static_cast<std::uint32_t>(i))]);
  }
  const glm::dvec3 target = -goal.reach * goal.direction;
  glm::dvec3 best = target;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const HalfSpace& c = constraints[i];
    if (glm::dot(c.normal, best) >= c.offset - kSlack) continue;
    const glm::dvec3 onPlane = target + (c.offset - glm::dot(c.normal, target)) * c.normal;
    const auto found = closestOnPlane(constraints.first(i), c, onPlane);
    if (!found) return std::nullopt;
    best = *found;
  }
  return best;
}

}  // namespace limn
