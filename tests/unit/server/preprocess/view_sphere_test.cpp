// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/view_sphere.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace limn {
namespace {

TEST(ViewSphere, OppositeNormalsFaceOppositeCells) {
  Rng rng(1);
  constexpr std::uint64_t kAll = (std::uint64_t{1} << kViewCells) - 1;
  for (int i = 0; i < 100; ++i) {
    // Odd numbers with a large third component: perpendicular to no cell.
    const glm::dvec3 normal(
        2.0 * rng.below(1000) + 1.0,
        2.0 * rng.below(1000) + 1.0,
        1e6 + rng.below(1000) + 0.5);
    EXPECT_EQ(facingCells(normal) ^ facingCells(-normal), kAll);
  }
}

// The views that see a silhouette between two faces fill a wedge: angle / π of the sphere.
TEST(ViewSphere, CellsBetweenTwoNormalsGrowWithTheirAngle) {
  Rng rng(2);
  for (const double angle : {0.0, 0.3, 0.8, 1.57, 2.5}) {
    double sum = 0.0;
    constexpr int kTrials = 400;
    for (int i = 0; i < kTrials; ++i) {
      const glm::dvec3 a =
          glm::normalize(glm::dvec3(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5));
      const glm::dvec3 side = glm::normalize(
          glm::cross(a, glm::dvec3(rng.uniform(), rng.uniform(), 1.5 + rng.uniform())));
      const glm::dvec3 b = std::cos(angle) * a + std::sin(angle) * side;
      sum += std::popcount(facingCells(a) ^ facingCells(b));
    }
    EXPECT_NEAR(sum / kTrials / kViewCells, angle / 3.14159265, 0.03) << angle;
  }
}

}  // namespace
}  // namespace limn
