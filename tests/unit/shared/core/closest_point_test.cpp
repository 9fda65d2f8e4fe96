// SPDX-License-Identifier: Apache-2.0
#include "shared/core/closest_point.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace limn {
namespace {

glm::dvec3 randomIn(Rng& rng) {
  return {2.0 * rng.uniform() - 1.0, 2.0 * rng.uniform() - 1.0, 2.0 * rng.uniform() - 1.0};
}

/// Frank and Wolfe's way to the closest point: always within the hull, never quite there.
glm::dvec3 nearlyClosest(const std::vector<glm::dvec3>& points) {
  glm::dvec3 at = points.front();
  for (int step = 0; step < 2000; ++step) {
    const auto farthest = std::min_element(
        points.begin(),
        points.end(),
        [&](const glm::dvec3& a, const glm::dvec3& b) {
          return glm::dot(at, a) < glm::dot(at, b);
        });
    const glm::dvec3 edge = *farthest - at;
    const double square = glm::dot(edge, edge);
    if (square == 0.0) break;
    const double t = std::clamp(-glm::dot(at, edge) / square, 0.0, 1.0);
    if (t == 0.0) break;
    at += t * edge;
  }
  return at;
}

TEST(ClosestPoint, NoPointIsNearerAndTheHullHasOneThere) {
  Rng rng(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<glm::dvec3> points(1 + rng.below(40));
    const glm::dvec3 shift = 2.0 * randomIn(rng);
    for (glm::dvec3& p : points)
      p = randomIn(rng) + shift;
    const glm::dvec3 closest = closestPointOfHull(points);
    const double square = glm::dot(closest, closest);
    // All points beyond the plane through it: none of the hull is nearer.
    for (const glm::dvec3& p : points)
      EXPECT_GE(glm::dot(closest, p), square - 1e-9);
    const double upper = glm::length(nearlyClosest(points));
    EXPECT_NEAR(std::sqrt(square), upper, 0.02) << round;
    EXPECT_LE(std::sqrt(square), upper + 1e-9);
  }
}

TEST(ClosestPoint, OfOneTwoOrThePointsOfAPlane) {
  const std::vector<glm::dvec3> one = {{1, 2, 3}};
  EXPECT_EQ(closestPointOfHull(one), glm::dvec3(1, 2, 3));
  const std::vector<glm::dvec3> two = {{1, -1, 0}, {1, 1, 0}, {1, -1, 0}};
  EXPECT_LT(glm::distance(closestPointOfHull(two), {1, 0, 0}), 1e-12);
  const std::vector<glm::dvec3> square = {{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}};
  EXPECT_LT(glm::distance(closestPointOfHull(square), {0, 0, 2}), 1e-12);
}

TEST(ClosestPoint, IsTheOriginWhereTheHullHasIt) {
  const std::vector<glm::dvec3> opposite = {{1, 0, 0}, {-1, 0, 0}};
  EXPECT_EQ(closestPointOfHull(opposite), glm::dvec3(0.0));
  Rng rng(2);
  for (int round = 0; round < 30; ++round) {
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 8; ++i) {
      points.push_back(glm::normalize(randomIn(rng)));
      points.push_back(-points.back() + 1e-3 * randomIn(rng));
    }
    if (glm::length(nearlyClosest(points)) > 5e-3) continue;  // just outside
    EXPECT_LT(glm::length(closestPointOfHull(points)), 1e-5);
  }
}

}  // namespace
}  // namespace limn
