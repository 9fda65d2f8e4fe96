// SPDX-License-Identifier: Apache-2.0
// Based on: P. V. Sander, X. Gu, S. J. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping",
// SIGGRAPH 2000, section 5 (anchored cones).
// Deviations: four sides, so that normals that differ one way only make them narrow; both have one
// axis, and their apexes are found by one pass over the planes instead of two linear programs, so
// that a test takes twelve 16-bit numbers and two offsets, and clusters can be refitted in a frame.
#include "shared/view/anchored_pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace limn {
namespace {

// Normals farther than acos of it from their mean are too far apart.
constexpr double kMinCosine = 0.2;
// Directions of the rectangle that are tried, over a right angle.
constexpr int kDirections = 6;

struct UnitPlane {
  glm::dvec3 normal;
  double distance;  // of the center
};

std::optional<std::vector<UnitPlane>> unitPlanes(
    std::span<const glm::vec4> planes,
    const glm::dvec3& center) {
  std::vector<UnitPlane> units;
  units.reserve(planes.size());
  for (const glm::vec4& plane : planes) {
    const glm::dvec3 n(plane);
    const double length = glm::length(n);
    if (length == 0.0) return std::nullopt;
    units.push_back({n / length, (glm::dot(n, center) + plane.w) / length});
  }
  return units;
}

// A rectangle across its axis: normals, each divided by its part along `mean`, are
// axis + x side1 + y side2, |x|, |y| ≤ 1.
struct Rectangle {
  glm::dvec3 axis{0.0};
  glm::dvec3 side1{0.0};
  glm::dvec3 side2{0.0};
};

std::optional<Rectangle> rectangleAround(std::span<const UnitPlane> planes) {
  glm::dvec3 sum(0.0);
  for (const UnitPlane& plane : planes)
    sum += plane.normal;
  if (glm::dot(sum, sum) < 1e-12) return std::nullopt;
  const glm::dvec3 mean = glm::normalize(sum);
  const glm::dvec3 other = std::abs(mean.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(mean, other));
  const glm::dvec3 up = glm::cross(mean, across);
  std::vector<glm::dvec2> places;
  places.reserve(planes.size());
  for (const UnitPlane& plane : planes) {
    const double along = glm::dot(plane.normal, mean);
    if (along < kMinCosine) return std::nullopt;
    places.emplace_back(glm::dot(plane.normal, across) / along, glm::dot(plane.normal, up) / along);
  }
  // First that in which they spread most, which for a narrow band is the one.
  glm::dvec2 middleOfAll(0.0);
  for (const glm::dvec2& p : places)
    middleOfAll += p / static_cast<double>(places.size());
  glm::dvec3 moments(0.0);  // xx, xy, yy
  for (const glm::dvec2& p : places) {
    const glm::dvec2 d = p - middleOfAll;
    moments += glm::dvec3(d.x * d.x, d.x * d.y, d.y * d.y);
  }
  const double first = 0.5 * std::atan2(2.0 * moments.y, moments.x - moments.z);
  // How many views see the cluster edge-on goes with the rectangle's circumference.
  Rectangle best;
  double least = std::numeric_limits<double>::max();
  for (int i = 0; i < kDirections; ++i) {
    const double angle = first + i * 0.5 * std::numbers::pi / kDirections;
    const glm::dvec2 direction(std::cos(angle), std::sin(angle));
    glm::dvec2 low(std::numeric_limits<double>::max());
    glm::dvec2 high = -low;
    for (const glm::dvec2& p : places) {
      const glm::dvec2 turned(
          direction.x * p.x + direction.y * p.y,
          direction.x * p.y - direction.y * p.x);
      low = glm::min(low, turned);
      high = glm::max(high, turned);
    }
    const glm::dvec2 half = 0.5 * (high - low);
    if (half.x + half.y >= least) continue;
    least = half.x + half.y;
    const glm::dvec3 x = direction.x * across + direction.y * up;
    const glm::dvec3 y = direction.x * up - direction.y * across;
    const glm::dvec2 middle = 0.5 * (low + high);
    best = {mean + middle.x * x + middle.y * y, half.x * x, half.y * y};
  }
  return best;
}

glm::dvec3 rounded(const glm::dvec3& v) {
  return {std::nearbyint(v.x), std::nearbyint(v.y), std::nearbyint(v.z)};
}

glm::dvec3 lengthened(const glm::dvec3& v, const glm::dvec3& otherwise, double by) {
  const double length = glm::length(v);
  return length > 0.0 ? v * (1.0 + by / length) : otherwise * by;
}

std::array<std::int16_t, 3> toFixed(const glm::dvec3& v) {
  const auto fixed = [](double x) { return static_cast<std::int16_t>(std::lrint(x)); };
  return {fixed(v.x), fixed(v.y), fixed(v.z)};
}

// What planes ask of a frame: by how much more the sides must reach (at most 1: enough), and the
// planes' distances over their normals' part along the axis.
struct Fit {
  glm::dvec2 reach{0.0};
  double front = std::numeric_limits<double>::max();
  double back = -std::numeric_limits<double>::max();
};

std::optional<Fit> fitOf(std::span<const UnitPlane> planes, const glm::dmat3& inverse) {
  Fit fit;
  for (const UnitPlane& plane : planes) {
    const glm::dvec3 parts = inverse * plane.normal;
    if (!(parts.x > 0.0)) return std::nullopt;
    const double share = 1.0 / parts.x;
    fit.reach = glm::max(fit.reach, glm::abs(glm::dvec2(parts.y, parts.z)) * share);
    fit.front = std::min(fit.front, plane.distance * share);
    fit.back = std::max(fit.back, plane.distance * share);
  }
  return fit;
}

}  // namespace

AnchoredPyramid fitAnchoredPyramid(
    std::span<const glm::vec4> planes,
    const glm::vec3& center,
    double tangentScale) {
  AnchoredPyramid pyramid;
  pyramid.center = center;
  const auto units = unitPlanes(planes, glm::dvec3(center));
  if (!units || units->empty()) return pyramid;
  auto rectangle = rectangleAround(*units);
  if (!rectangle) return pyramid;
  // Rounding turns the vectors a little: the sides grow until they hold all normals again.
  constexpr int kTries = 6;
  constexpr double kRoom = 16.0;
  double longest = glm::length(rectangle->axis);
  longest = std::max(longest, glm::length(rectangle->side1));
  longest = std::max(longest, glm::length(rectangle->side2));
  const double scale = (AnchoredPyramid::kScale - kRoom) / longest;
  const glm::dvec3 axis = rounded(rectangle->axis * scale);
  const glm::dvec3 anyAcross = glm::normalize(glm::cross(
      axis,
      std::abs(axis.x) < std::abs(axis.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  // So long, rounding cannot make them parallel.
  constexpr double kLeast = 2.0;
  glm::dvec3 side1 = lengthened(rectangle->side1 * scale, anyAcross, kLeast);
  const glm::dvec3 across = glm::normalize(glm::cross(axis, side1));
  glm::dvec3 side2 = lengthened(rectangle->side2 * scale, across, kLeast);
  for (int i = 0; i < kTries; ++i) {
    const glm::dmat3 frame(axis, rounded(side1), rounded(side2));
    const double volume = glm::determinant(frame);
    if (std::abs(volume) < 1.0) return pyramid;
    const auto fit = fitOf(*units, glm::inverse(frame));
    if (!fit) return pyramid;
    // Far more than double precision loses.
    constexpr double kEnough = 1.0 - 1e-9;
    if (fit->reach.x <= kEnough && fit->reach.y <= kEnough) {
      pyramid.axis = toFixed(axis);
      pyramid.side1 = toFixed(frame[1] * tangentScale);
      pyramid.side2 = toFixed(frame[2] * tangentScale);
      pyramid.front = std::nextafter(static_cast<float>(fit->front), -3e38F);
      pyramid.back = std::nextafter(static_cast<float>(fit->back), 3e38F);
      return pyramid;
    }
    const auto grown = [](const glm::dvec3& side, double reach) {
      const double length = glm::length(side);
      return lengthened(side, side, reach > kEnough ? 0.5 + (reach - 1.0) * length : 0.0);
    };
    side1 = grown(side1, fit->reach.x);
    side2 = grown(side2, fit->reach.y);
    if (glm::length(side1) > AnchoredPyramid::kScale) return pyramid;
    if (glm::length(side2) > AnchoredPyramid::kScale) return pyramid;
  }
  return pyramid;
}

PlanesSide sideOf(const AnchoredPyramid& pyramid, const glm::vec4& eye, float extent) {
  const float slack = PyramidSlack::kDistance * static_cast<float>(AnchoredPyramid::kScale) *
                      (glm::length(glm::vec3(eye)) + extent * eye.w);
  const glm::vec3 q = glm::vec3(eye) - pyramid.center * eye.w;
  const auto along = [&](const std::array<std::int16_t, 3>& v) {
    return q.x * static_cast<float>(v[0]) + q.y * static_cast<float>(v[1]) +
           q.z * static_cast<float>(v[2]);
  };
  const float across = std::abs(along(pyramid.side1)) + std::abs(along(pyramid.side2)) + slack;
  const float middle = along(pyramid.axis);
  if (middle + pyramid.front * eye.w > across) return PlanesSide::kFront;
  if (middle + pyramid.back * eye.w < -across) return PlanesSide::kBack;
  return PlanesSide::kUnknown;
}

}  // namespace limn
