// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. V. Sander et al., "Silhouette Clipping", SIGGRAPH 2000, section 5, P(r). Deviations:
// cones are predicted from a sample of the planes, with both origins on one line through the
// cluster's middle. The share of a ball of radius R that two cones of half-angle t leave, their
// origins `separation` apart near the middle, is to first order in separation / R
//   cos t + ¾ sin² t · separation / R:
// the distance from an origin to the ball's surface in a direction is R less the origin's own
// component along it.
#include "server/contour/plane_sample.h"

#include "shared/core/closest_point.h"

#include <algorithm>
#include <limits>

namespace limn {
namespace {

constexpr std::size_t kSectors = 8;
constexpr std::size_t kApexes = 4;  // of each kind

/// Planes of two samples, and their cones.
class Union {
 public:
  Union(const PlaneSample& a, const PlaneSample& b, const glm::vec2& weights)
      : isEmpty_(a.hasDegenerate || b.hasDegenerate),
        center_((weights.x * a.center + weights.y * b.center) / (weights.x + weights.y)) {
    for (const PlaneSample* s : {&a, &b}) {
      for (const glm::vec4& plane : s->all()) {
        planes_[count_] = plane;
        normals_[count_++] = glm::dvec3(plane);
      }
    }
  }

  double missed(double eyeRadius) {
    if (isEmpty_ || count_ == 0) return 1.0;
    const glm::dvec3 closest = closestPointOfHull({normals_.data(), count_}, 1e-4);
    const double length = glm::length(closest);
    if (length == 0.0) return 1.0;
    axis_ = closest / length;
    double cosine = 1.0;
    double front = -std::numeric_limits<double>::max();
    double back = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < count_; ++i) {
      cosines_[i] = glm::dot(normals_[i], axis_);
      if (cosines_[i] <= 0.0) return 1.0;
      apexes_[i] = -(glm::dot(normals_[i], glm::dvec3(center_)) + planes_[i].w) / cosines_[i];
      cosine = std::min(cosine, cosines_[i]);
      front = std::max(front, apexes_[i]);
      back = std::min(back, apexes_[i]);
    }
    hasCones_ = true;
    const double square = cosine * cosine;
    return std::min(
        1.0,
        std::sqrt(std::max(0.0, 1.0 - square)) + 0.75 * square * (front - back) / eyeRadius);
  }

  /// After missed(): the planes farthest from the axis in each direction around it, and those that
  /// the origins lie on.
  PlaneSample sample() const {
    PlaneSample result;
    result.center = center_;
    result.hasDegenerate = isEmpty_;
    if (isEmpty_) return result;
    if (!hasCones_ || count_ <= PlaneSample::kMost) {
      // Without cones it has none in any larger cluster either; which planes say so is no matter.
      result.count = static_cast<std::uint32_t>(std::min(count_, PlaneSample::kMost));
      std::copy_n(planes_.begin(), result.count, result.planes.begin());
      result.hasDegenerate = !hasCones_;
      return result;
    }
    std::array<bool, kAll> taken{};
    takeWidest(taken);
    takeApexes(1.0, taken);
    takeApexes(-1.0, taken);
    for (std::size_t i = 0; i < count_; ++i) {
      if (taken[i]) result.planes[result.count++] = planes_[i];
    }
    return result;
  }

 private:
  static constexpr std::size_t kAll = 2 * PlaneSample::kMost;

  void takeWidest(std::array<bool, kAll>& taken) const {
    const glm::dvec3 side = std::abs(axis_.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(axis_, side));
    const glm::dvec3 v = glm::cross(axis_, u);
    std::array<std::size_t, kSectors> widest{};
    widest.fill(kAll);
    for (std::size_t i = 0; i < count_; ++i) {
      const double x = glm::dot(normals_[i], u);
      const double y = glm::dot(normals_[i], v);
      const std::size_t sector =
          (x > 0.0 ? 1U : 0U) | (y > 0.0 ? 2U : 0U) | (std::abs(x) > std::abs(y) ? 4U : 0U);
      if (widest[sector] == kAll || cosines_[i] < cosines_[widest[sector]]) widest[sector] = i;
    }
    for (const std::size_t i : widest) {
      if (i != kAll) taken[i] = true;
    }
  }

  void takeApexes(double sign, std::array<bool, kAll>& taken) const {
    for (std::size_t round = 0; round < kApexes; ++round) {
      std::size_t best = kAll;
      for (std::size_t i = 0; i < count_; ++i) {
        if (!taken[i] && (best == kAll || sign * apexes_[i] > sign * apexes_[best])) best = i;
      }
      if (best != kAll) taken[best] = true;
    }
  }

  bool isEmpty_;
  bool hasCones_ = false;
  glm::vec3 center_;
  std::size_t count_ = 0;
  std::array<glm::vec4, kAll> planes_{};
  std::array<glm::dvec3, kAll> normals_{};
  std::array<double, kAll> cosines_{};
  std::array<double, kAll> apexes_{};
  glm::dvec3 axis_{0.0};
};

}  // namespace

JoinedSample
join(const PlaneSample& a, const PlaneSample& b, const glm::vec2& weights, double eyeRadius) {
  Union both(a, b, weights);
  JoinedSample result;
  result.missed = both.missed(eyeRadius);
  result.sample = both.sample();
  return result;
}

double missedByJoin(
    const PlaneSample& a,
    const PlaneSample& b,
    const glm::vec2& weights,
    double eyeRadius) {
  return Union(a, b, weights).missed(eyeRadius);
}

}  // namespace limn
