// SPDX-License-Identifier: GPL-3.0-or-later
// GPL because of CGAL's intersection tests, the oracle here.
#include "server/preprocess/hulls/triangle_crossing.h"

#include "shared/core/rng.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <gtest/gtest.h>

namespace limn::hull {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;

Kernel::Point_3 toCgal(const glm::ivec3& p) {
  return {p.x, p.y, p.z};
}

Kernel::Triangle_3 toCgal(const Triangle& t) {
  return {toCgal(t[0]), toCgal(t[1]), toCgal(t[2])};
}

/// Small coordinates, so that touching, coplanar and collinear cases are common.
glm::ivec3 randomPoint(Rng& rng, std::uint32_t size) {
  const auto at = [&] { return static_cast<int>(rng.below(size)); };
  return {at(), at(), at()};
}

Triangle randomTriangle(Rng& rng, std::uint32_t size) {
  return {randomPoint(rng, size), randomPoint(rng, size), randomPoint(rng, size)};
}

TEST(TriangleCrossing, AgreesWithExactArithmeticOnTrianglesWithoutCommonCorners) {
  Rng rng(5);
  int met = 0;
  for (int round = 0; round < 4000; ++round) {
    const std::uint32_t size = round % 2 == 0 ? 5 : 1 << 20;
    const Triangle s = randomTriangle(rng, size);
    const Triangle t = randomTriangle(rng, size);
    if (toCgal(s).is_degenerate() || toCgal(t).is_degenerate()) {
      EXPECT_FALSE(trianglesMeet(s, t));
      continue;
    }
    const bool expected = CGAL::do_intersect(toCgal(s), toCgal(t));
    EXPECT_EQ(trianglesMeet(s, t), expected) << "round " << round;
    EXPECT_EQ(facesMeet({0, 1, 2}, s, {3, 4, 5}, t), expected);
    met += expected ? 1 : 0;
  }
  EXPECT_GT(met, 500);
}

TEST(TriangleCrossing, AgreesAboutTrianglesWithACommonCorner) {
  Rng rng(6);
  int met = 0;
  for (int round = 0; round < 3000; ++round) {
    Triangle s = randomTriangle(rng, 5);
    Triangle t = randomTriangle(rng, 5);
    t[1] = s[2];
    if (toCgal(s).is_degenerate() || toCgal(t).is_degenerate()) continue;
    const Kernel::Segment_3 oppositeS(toCgal(s[0]), toCgal(s[1]));
    const Kernel::Segment_3 oppositeT(toCgal(t[0]), toCgal(t[2]));
    const bool expected =
        CGAL::do_intersect(oppositeS, toCgal(t)) || CGAL::do_intersect(oppositeT, toCgal(s));
    EXPECT_EQ(facesMeet({0, 1, 2}, s, {3, 2, 4}, t), expected) << "round " << round;
    met += expected ? 1 : 0;
  }
  EXPECT_GT(met, 300);
}

TEST(TriangleCrossing, TrianglesWithACommonEdgeMeetWhenOneIsFoldedOntoTheOther) {
  const Triangle s{glm::ivec3(0, 0, 0), glm::ivec3(4, 0, 2), glm::ivec3(0, 4, 2)};
  const glm::ivec3 same(4, 8, 6);       // in the plane of s, on its side of edge 0–1
  const glm::ivec3 opposite(4, -4, 0);  // in the plane of s, beyond that edge
  EXPECT_TRUE(facesMeet({0, 1, 2}, s, {1, 0, 3}, {s[1], s[0], same}));
  EXPECT_FALSE(facesMeet({0, 1, 2}, s, {1, 0, 3}, {s[1], s[0], opposite}));
  EXPECT_FALSE(facesMeet({0, 1, 2}, s, {1, 0, 3}, {s[1], s[0], glm::ivec3(1, 1, 5)}));
}

}  // namespace
}  // namespace limn::hull
