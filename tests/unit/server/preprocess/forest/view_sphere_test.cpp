// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/view_sphere.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace limn {
namespace {

TEST(ViewSphere, OppositeFacesHaveASilhouetteFromEverywhereAndOneFaceFromNowhere) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    // Perpendicular to no cell.
    const glm::vec3 normal(
        0.01 + 0.1 * rng.uniform(),
        0.01 + 0.1 * rng.uniform(),
        1.0 + rng.uniform());
    EXPECT_EQ(silhouetteCells(std::array{normal, -normal}), kViewCells);
    EXPECT_EQ(silhouetteCells(std::array{normal, 3.0F * normal}), 0);
  }
  EXPECT_EQ(silhouetteCells({}), 0);
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
      sum += silhouetteCells(std::array{glm::vec3(a), glm::vec3(b)});
    }
    EXPECT_NEAR(sum / kTrials / kViewCells, angle / 3.14159265, 0.03) << angle;
  }
}

}  // namespace
}  // namespace limn
