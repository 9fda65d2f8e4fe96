// SPDX-License-Identifier: Apache-2.0
#include "shared/core/camera.h"
#include "shared/core/rng.h"
#include "shared/view/anchored_pyramid.h"
#include "shared/view/normal_cone.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace limn {
namespace {

glm::dvec3 randomUnit(Rng& rng) {
  const double z = 2.0 * rng.uniform() - 1.0;
  const double angle = 6.283185307179586 * rng.uniform();
  const double ring = std::sqrt(1.0 - z * z);
  return {ring * std::cos(angle), ring * std::sin(angle), z};
}

// Planes through points about `center` whose normals lie about `axis`.
std::vector<glm::vec4>
randomPlanes(Rng& rng, const glm::dvec3& center, const glm::dvec3& axis, double spread) {
  std::vector<glm::vec4> planes;
  for (int i = 0; i < 32; ++i) {
    const glm::dvec3 normal = glm::normalize(axis + spread * randomUnit(rng));
    const glm::dvec3 point = center + 20.0 * randomUnit(rng);
    const glm::vec3 n(normal * (1.0 + 100.0 * rng.uniform()));
    planes.emplace_back(n, static_cast<float>(-glm::dot(glm::dvec3(n), point)));
  }
  return planes;
}

int countFront(const std::vector<glm::vec4>& planes, const glm::vec4& eye) {
  int count = 0;
  for (const glm::vec4& plane : planes) {
    if (((plane.x * eye.x + plane.y * eye.y) + plane.z * eye.z) + plane.w * eye.w > 0.0F) ++count;
  }
  return count;
}

// A random direction within the cone, often on its rim.
glm::dvec3 randomInside(Rng& rng, const NormalCone& cone) {
  const double half = std::acos(std::clamp(cone.cosHalf, -1.0, 1.0));
  const double angle = half * std::min(1.0, 2.0 * rng.uniform());
  const glm::dvec3 side = glm::normalize(glm::cross(cone.axis, randomUnit(rng)));
  return std::cos(angle) * cone.axis + std::sin(angle) * side;
}

TEST(NormalCone, MergedHoldsBothAndIsNoWiderThanTheirOpening) {
  Rng rng(4);
  int narrow = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double spread = std::pow(10.0, -4.0 * rng.uniform());
    const NormalCone a{randomUnit(rng), std::cos(0.7 * spread * rng.uniform())};
    const NormalCone b{
        glm::normalize(a.axis + spread * randomUnit(rng)),
        trial % 3 == 0 ? 1.0 : std::cos(0.7 * spread * rng.uniform())};
    const NormalCone both = mergedCone(a, b);
    for (int i = 0; i < 20; ++i) {
      const glm::dvec3 direction = randomInside(rng, i % 2 == 0 ? a : b);
      EXPECT_GE(glm::dot(both.axis, direction), both.cosHalf - 1e-13);
    }
    // The slow way: angles.
    const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
    const double between = angle(glm::dot(a.axis, b.axis));
    const double widest = std::max(angle(a.cosHalf), angle(b.cosHalf));
    const double opening = std::max(widest, 0.5 * (between + angle(a.cosHalf) + angle(b.cosHalf)));
    if (both.cosHalf == -1.0) {
      EXPECT_GE(opening, 1.57);
    } else {
      EXPECT_LE(angle(both.cosHalf), opening + 2e-6);
      ++narrow;
    }
  }
  EXPECT_GT(narrow, 1500);
}

TEST(NormalCone, MergedWithEverythingIsEverything) {
  const NormalCone narrow{{0.0, 0.0, 1.0}, 0.9};
  EXPECT_EQ(mergedCone(narrow, NormalCone{}).cosHalf, -1.0);
  EXPECT_EQ(mergedCone(NormalCone{}, narrow).cosHalf, -1.0);
  const NormalCone opposed{{0.0, 0.0, -1.0}, 1.0};
  EXPECT_EQ(mergedCone({{0.0, 0.0, 1.0}, 1.0}, opposed).cosHalf, -1.0);
}

TEST(AnchoredPyramid, NeverClaimsMoreThanTheFloatPlanesSay) {
  Rng rng(2);
  int claims = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const glm::dvec3 center = 5000.0 * randomUnit(rng);
    const auto planes = randomPlanes(rng, center, randomUnit(rng), 0.6 * rng.uniform());
    const AnchoredPyramid pyramid = fitAnchoredPyramid(planes, glm::vec3(center));
    for (int i = 0; i < 200; ++i) {
      const double distance = std::pow(10.0, 1.0 + 4.5 * rng.uniform());
      const glm::vec4 eye = i % 4 == 0
                                ? glm::vec4(glm::vec3(randomUnit(rng)), 0.0F)
                                : glm::vec4(glm::vec3(center + distance * randomUnit(rng)), 1.0F);
      const PlanesSide side = sideOf(pyramid, eye, 6000.0F);
      const int front = countFront(planes, eye);
      if (side == PlanesSide::kFront) {
        ASSERT_EQ(front, 32);
      }
      if (side == PlanesSide::kBack) {
        ASSERT_EQ(front, 0);
      }
      claims += side == PlanesSide::kUnknown ? 0 : 1;
    }
  }
  EXPECT_GT(claims, 20000);  // of 60,000: they do prove something
}

TEST(AnchoredPyramid, WithAPlaneWithoutAreaIsEmpty) {
  const std::array<glm::vec4, 2> planes = {glm::vec4(0, 0, 1, 0), glm::vec4(0)};
  const AnchoredPyramid pyramid = fitAnchoredPyramid(planes, glm::vec3(0));
  EXPECT_EQ(sideOf(pyramid, glm::vec4(0, 0, 10, 1), 1.0F), PlanesSide::kUnknown);
  EXPECT_EQ(sideOf(pyramid, glm::vec4(0, 0, 1, 0), 1.0F), PlanesSide::kUnknown);
}

// A round cone about normals 0.6 rad apart would say nothing of an eye less than 0.3 rad above.
TEST(AnchoredPyramid, IsNarrowWhereNormalsTurnOneWayOnly) {
  Rng rng(4);
  for (int trial = 0; trial < 50; ++trial) {
    const glm::dvec3 up = randomUnit(rng);
    const glm::dvec3 along = glm::normalize(glm::cross(up, randomUnit(rng)));
    const glm::dvec3 across = glm::cross(up, along);
    std::vector<glm::vec4> planes;
    for (int i = 0; i < 32; ++i) {
      const double turn = 0.3 * (2.0 * rng.uniform() - 1.0);
      const glm::dvec3 n = std::cos(turn) * up + std::sin(turn) * across;
      planes.emplace_back(glm::vec3(n), static_cast<float>(-glm::dot(n, n - up)));
    }
    const AnchoredPyramid pyramid = fitAnchoredPyramid(planes, glm::vec3(0));
    const glm::vec4 eye(glm::vec3(1000.0 * (along + 0.05 * up)), 1.0F);
    EXPECT_EQ(sideOf(pyramid, eye, 2.0F), PlanesSide::kFront);
    const glm::vec4 below(glm::vec3(1000.0 * (along - 0.05 * up)), 1.0F);
    EXPECT_EQ(sideOf(pyramid, below, 2.0F), PlanesSide::kBack);
  }
}

TEST(AnchoredPyramid, OfOnePlaneKnowsItsSidesAlmostEverywhere) {
  Rng rng(5);
  for (int trial = 0; trial < 100; ++trial) {
    const glm::dvec3 n = randomUnit(rng);
    const std::vector<glm::vec4> planes(32, glm::vec4(glm::vec3(3.0 * n), 0.0F));
    const AnchoredPyramid pyramid = fitAnchoredPyramid(planes, glm::vec3(0));
    const glm::dvec3 beside = glm::normalize(glm::cross(n, randomUnit(rng)));
    const glm::vec4 above(glm::vec3(beside + 0.001 * n), 0.0F);
    EXPECT_EQ(sideOf(pyramid, above, 1.0F), PlanesSide::kFront);
    const glm::vec4 below(glm::vec3(beside - 0.001 * n), 0.0F);
    EXPECT_EQ(sideOf(pyramid, below, 1.0F), PlanesSide::kBack);
  }
}

}  // namespace
}  // namespace limn
