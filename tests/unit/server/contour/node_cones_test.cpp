// SPDX-License-Identifier: Apache-2.0
#include "server/contour/node_cones.h"

#include "shared/silhouette/field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace limn {
namespace {

glm::dvec3 directionOf(Rng& rng) {
  while (true) {
    const glm::dvec3 d(2 * rng.uniform() - 1, 2 * rng.uniform() - 1, 2 * rng.uniform() - 1);
    const double length = glm::length(d);
    if (length > 0.1 && length < 1.0) return d / length;
  }
}

struct Cluster {
  std::vector<glm::vec4> planes;
  glm::dvec3 center{0.0};
  double radius = 1.0;
};

/// Planes through points of a ball, their normals within some angle of one direction; areas differ.
Cluster randomCluster(Rng& rng) {
  Cluster cluster;
  cluster.center = 8000.0 * (rng.uniform() * directionOf(rng));
  cluster.radius = std::pow(10.0, 4.0 * rng.uniform());
  const glm::dvec3 main = directionOf(rng);
  const double spread = std::pow(10.0, -4.0 * rng.uniform());
  const std::uint32_t count = 1 + rng.below(40);
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::dvec3 through = cluster.center + cluster.radius * (rng.uniform() * directionOf(rng));
    const glm::dvec3 normal =
        glm::normalize(main + spread * directionOf(rng)) * std::pow(10.0, 4.0 * rng.uniform());
    cluster.planes.emplace_back(glm::vec3(normal), static_cast<float>(-glm::dot(normal, through)));
  }
  return cluster;
}

/// Near, far and infinitely far eyes.
glm::vec4 randomEye(const Cluster& cluster, Rng& rng) {
  const glm::dvec3 direction = directionOf(rng);
  if (rng.below(5) == 0) return glm::vec4(glm::vec3(direction), 0.0F);
  const double away = cluster.radius * std::pow(10.0, 4.0 * rng.uniform() - 2.0);
  return glm::vec4(glm::vec3(cluster.center + away * direction), 1.0F);
}

enum class Seen { kFront, kBack, kBoth };

Seen seenFrom(const Cluster& cluster, const glm::vec4& eye) {
  std::size_t fronts = 0;
  for (const glm::vec4& plane : cluster.planes)
    fronts += SilhouetteField::valueAt(plane, eye) > 0.0F ? 1U : 0U;
  return fronts == 0 ? Seen::kBack : fronts == cluster.planes.size() ? Seen::kFront : Seen::kBoth;
}

TEST(NodeCones, HoldOnlyEyesThatSeeAllPlanesFromOneSideAndMostOfThose) {
  Rng rng(1);
  Rng order(2);
  std::size_t held = 0;
  std::size_t oneSided = 0;
  for (int round = 0; round < 2000; ++round) {
    const Cluster cluster = randomCluster(rng);
    const NodeCones cones = fitNodeCones(cluster.planes, cluster.center, cluster.radius, order);
    for (int i = 0; i < 100; ++i) {
      const glm::vec4 eye = randomEye(cluster, rng);
      const bool isOneSided = seenFrom(cluster, eye) != Seen::kBoth;
      const bool isHeld = cones.contain(eye);
      ASSERT_TRUE(isOneSided || !isHeld) << round;
      held += isHeld ? 1U : 0U;
      oneSided += isOneSided ? 1U : 0U;
    }
  }
  EXPECT_GT(oneSided, 50000U);
  // Cones are round and regions are not.
  EXPECT_GT(held, oneSided * 8 / 10);
}

// The negative control: were the comparison above blind, this would pass, too.
TEST(NodeCones, WidenedByATenthHoldEyesThatSeeBothSides) {
  Rng rng(1);
  Rng order(2);
  std::size_t wrong = 0;
  for (int round = 0; round < 200; ++round) {
    const Cluster cluster = randomCluster(rng);
    NodeCones cones = fitNodeCones(cluster.planes, cluster.center, cluster.radius, order);
    cones.scaledNormal *= 1.1F;
    cones.separation *= 1.1F;
    for (int i = 0; i < 100; ++i) {
      const glm::vec4 eye = randomEye(cluster, rng);
      wrong += cones.contain(eye) && seenFrom(cluster, eye) == Seen::kBoth ? 1U : 0U;
    }
  }
  EXPECT_GT(wrong, 0U);
}

TEST(NodeCones, AreAsLargeAsTheRegionsOfOnePlaneAndOfASymmetricFan) {
  Rng order(1);
  // z ≥ 3: the cone is the half space, but for its slack.
  const std::vector<glm::vec4> one = {{0.0F, 0.0F, 2.0F, -6.0F}};
  const NodeCones half = fitNodeCones(one, {0.0, 0.0, 3.0}, 1.0, order);
  EXPECT_TRUE(half.contain({1000.0F, 0.0F, 3.1F, 1.0F}));
  EXPECT_TRUE(half.contain({1000.0F, 0.0F, 2.9F, 1.0F}));
  EXPECT_FALSE(half.contain({1000.0F, 0.0F, 3.0F, 1.0F}));
  // A pyramid's sides, sloped by 45 degrees, apex (0, 0, 5): what sees all of
  // them is above it.
  std::vector<glm::vec4> pyramid;
  for (int k = 0; k < 4; ++k) {
    const auto x = static_cast<float>(k == 0) - static_cast<float>(k == 1);
    const auto y = static_cast<float>(k == 2) - static_cast<float>(k == 3);
    pyramid.emplace_back(x, y, 1.0F, -5.0F);
  }
  const NodeCones cones = fitNodeCones(pyramid, {0.0, 0.0, 4.0}, 2.0, order);
  EXPECT_TRUE(cones.contain({0.0F, 0.0F, 5.001F, 1.0F}));
  EXPECT_TRUE(cones.contain({0.98F, 0.0F, 6.0F, 1.0F}));
  EXPECT_FALSE(cones.contain({1.02F, 0.0F, 6.0F, 1.0F}));
  EXPECT_TRUE(cones.contain({0.0F, 0.0F, 4.999F, 1.0F}));  // from the back
  EXPECT_FALSE(cones.contain({2.0F, 0.0F, 4.5F, 1.0F}));
}

TEST(NodeCones, AreEmptyWhereNormalsOpposeOrOneIsMissing) {
  Rng order(1);
  const std::vector<glm::vec4> opposed = {{0.0F, 0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, -1.0F, 0.0F}};
  const std::vector<glm::vec4> missing = {{0.0F, 0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 0.0F, 0.0F}};
  for (const auto& planes : {opposed, missing}) {
    const NodeCones cones = fitNodeCones(planes, {0.0, 0.0, 0.0}, 1.0, order);
    for (const float z : {-100.0F, 0.0F, 100.0F})
      EXPECT_FALSE(cones.contain({0.0F, 0.0F, z, 1.0F}));
  }
}

}  // namespace
}  // namespace limn
