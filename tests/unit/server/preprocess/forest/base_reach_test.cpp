// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/base_reach.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <array>

namespace limn {
namespace {

std::array<std::uint32_t, 3> counts(const TriangleMesh& mesh) {
  const MeshTopology topology = topologyOf(mesh);
  return {topology.pieces, topology.holes, topology.tunnels};
}

TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const glm::uvec3& t : b.triangles)
    a.triangles.push_back(t + offset);
  return a;
}

TEST(BaseReach, CountsPiecesHolesAndTunnels) {
  using Counts = std::array<std::uint32_t, 3>;
  EXPECT_EQ(counts(primitives::icosphere(2)), (Counts{1, 0, 0}));
  EXPECT_EQ(counts(primitives::torus(20, 10)), (Counts{1, 0, 1}));
  EXPECT_EQ(counts(primitives::openGrid(5, 4)), (Counts{1, 1, 0}));
  const TriangleMesh pair = joined(primitives::torus(20, 10), primitives::openGrid(5, 4));
  EXPECT_EQ(counts(joined(pair, primitives::torus(8, 6))), (Counts{3, 1, 2}));
  TriangleMesh pierced = primitives::icosphere(2);
  pierced.triangles.erase(pierced.triangles.begin() + 40);
  pierced.triangles.erase(pierced.triangles.begin());
  EXPECT_EQ(counts(pierced), (Counts{1, 2, 0}));
}

TEST(BaseReach, SaysWhyOnlyWhereMoreWasAskedThanCanBe) {
  EXPECT_EQ(whyBaseIsLarger(800, 800, {}), "");
  const std::string why = whyBaseIsLarger(832, 800, {151, 407, 1});
  EXPECT_NE(why.find("832 faces, not 800"), std::string::npos) << why;
  EXPECT_NE(why.find("151 pieces, 407 holes and 1 tunnel,"), std::string::npos) << why;
}

}  // namespace
}  // namespace limn
