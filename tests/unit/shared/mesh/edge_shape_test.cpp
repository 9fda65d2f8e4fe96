// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/edge_shape.h"

#include "shared/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace limn {
namespace {

/// Two faces over the edge from a to b, the second with its corner d above or below the first.
bool isConcaveWith(std::int32_t least, std::int32_t most, std::int32_t height) {
  const std::array<glm::uvec3, 2> faces = {{{0, 1, 2}, {1, 0, 3}}};
  const auto mesh = HalfEdgeMesh::build(4, faces);
  const std::vector<glm::ivec3> positions = {
      {least, least, least},
      {most, least, least},
      {least, most, least},
      {least, least, height}};
  return isConcave(*mesh, positions, mesh->find(0, 1));
}

TEST(EdgeShape, AnEdgeIsConcaveWhereTheOtherFaceRisesAboveThisOne) {
  EXPECT_TRUE(isConcaveWith(0, 10, 1));
  EXPECT_FALSE(isConcaveWith(0, 10, 0));
  EXPECT_FALSE(isConcaveWith(0, 10, -1));
}

TEST(EdgeShape, ConcavityIsExactForTheLargestCoordinates) {
  EXPECT_TRUE(isConcaveWith(-kMaxGridCoordinate, kMaxGridCoordinate, kMaxGridCoordinate));
  EXPECT_FALSE(isConcaveWith(-kMaxGridCoordinate, kMaxGridCoordinate, -kMaxGridCoordinate));
  EXPECT_TRUE(isConcaveWith(-kMaxGridCoordinate, kMaxGridCoordinate, 1 - kMaxGridCoordinate));
}

}  // namespace
}  // namespace limn
