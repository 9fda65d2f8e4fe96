// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. V. Sander, X. Gu, S. J. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping",
// SIGGRAPH 2000, section 5 (anchored cone construction). Deviation: the cones are a little smaller
// than they could be, so that what they claim holds for floats. With u = 2⁻²⁴:
//  - The value of a plane at an eye e is off by at most 4.01 u (|e| + |w|/|n|) |n|, and |e| is at
//    most |e − o| + |o|, o being the cone's origin.
//  - A cone narrower by kAngle has n · (e − o) > 200 u |e − o| |n| inside: what rounding of that
//    difference and of the cone's own test (8 u of it at most), and the value's error in |e − o|
//    take away is far less.
//  - Origins lie deeper in their half spaces by kDepth (|o| + |w|/|n|), which makes up for the
//  rest.
//  - The back cone's test goes through the front origin, so the separation grows by what that
//  rounds.
#include "server/contour/node_cones.h"

#include "shared/core/closest_point.h"
#include "shared/core/linear_program.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace limn {
namespace {

constexpr double kAngle = 0x1p-16;  // 256 u
constexpr double kDepth = 0x1p-20;  // 16 u
/// Origins farther than this many radii from the centre come from nearly parallel planes; floats
/// serve them badly.
constexpr double kFarthest = 1e3;

/// Planes of unit normal as n · x ≥ offset, or their backs.
class Origins {
 public:
  Origins(std::span<const HalfSpace> spaces, const glm::dvec3& axis, double extent)
      : spaces_(spaces),
        axis_(axis),
        extent_(extent) {}

  /// The point lowest along the axis within all half spaces, as a float vector that is.
  std::optional<glm::vec3> lowest(const glm::dvec3& center, double radius, Rng& order) {
    const double depth = depthAt(glm::length(center) + 4.0 * radius);
    local_.clear();
    for (const HalfSpace& s : spaces_)
      local_.push_back({s.normal, (s.offset + depth - glm::dot(s.normal, center)) / radius});
    const auto found = solveLinearProgram(local_, {axis_, 1e5}, order);
    if (found && glm::length(*found) <= kFarthest) {
      if (const auto point = corrected(center + radius * *found)) return point;
    }
    return corrected(center);
  }

 private:
  [[nodiscard]] double depthAt(double distance) const { return kDepth * (distance + extent_); }

  /// Moves a point along the axis until all half spaces have it.
  [[nodiscard]] std::optional<glm::vec3> corrected(const glm::dvec3& point) const {
    glm::vec3 stored(point);
    for (int round = 0; round < 4; ++round) {
      const double depth = depthAt(glm::length(glm::dvec3(stored)));
      double missing = 0.0;
      for (const HalfSpace& s : spaces_) {
        const double lacks = s.offset + depth - glm::dot(s.normal, glm::dvec3(stored));
        if (lacks > 0.0) missing = std::max(missing, lacks / glm::dot(s.normal, axis_));
      }
      if (missing == 0.0) return stored;
      stored = glm::vec3(glm::dvec3(stored) + (1.01 * missing + 0.1 * depth) * axis_);
    }
    return std::nullopt;
  }

  std::span<const HalfSpace> spaces_;
  glm::dvec3 axis_;
  double extent_;
  std::vector<HalfSpace> local_;
};

}  // namespace

NodeCones fitNodeCones(
    std::span<const glm::vec4> planes,
    const glm::dvec3& center,
    double radius,
    Rng& order) {
  std::vector<glm::dvec3> normals;
  std::vector<HalfSpace> fronts;
  std::vector<HalfSpace> backs;
  double extent = 0.0;
  for (const glm::vec4& plane : planes) {
    const glm::dvec3 n(plane);
    const double length = glm::length(n);
    if (length == 0.0) return {};
    normals.push_back(n / length);
    const double offset = plane.w / length;
    fronts.push_back({normals.back(), -offset});
    backs.push_back({-normals.back(), offset});
    extent = std::max(extent, std::abs(offset));
  }
  if (normals.empty()) return {};
  const glm::dvec3 closest = closestPointOfHull(normals);
  if (glm::dot(closest, closest) == 0.0) return {};
  const glm::dvec3 axis = glm::normalize(closest);
  double cosine = 1.0;  // of the largest angle of a normal with the axis
  for (const glm::dvec3& n : normals)
    cosine = std::min(cosine, glm::dot(n, axis));
  // The cones' half-angle is that one's complement, less a little.
  const double cosHalf = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) + kAngle;
  if (cosine <= 0.0 || cosHalf >= 1.0) return {};
  const auto front = Origins(fronts, axis, extent).lowest(center, radius, order);
  const auto back = Origins(backs, -axis, extent).lowest(center, radius, order);
  if (!front || !back) return {};
  NodeCones cones;
  cones.scaledNormal = glm::vec3(axis * ((1.0 - 0x1p-21) / cosHalf));
  cones.front = *front;
  cones.back = *back;
  const glm::dvec3 scaled(cones.scaledNormal);
  const double rounding =
      kDepth * (glm::length(glm::dvec3(*front)) + glm::length(glm::dvec3(*back)));
  cones.separation = static_cast<float>(
      glm::dot(glm::dvec3(*front) - glm::dvec3(*back), scaled) + rounding * glm::length(scaled));
  return cones;
}

}  // namespace limn
