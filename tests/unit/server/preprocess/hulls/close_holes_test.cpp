// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/hulls/close_holes.h"

#include "shared/mesh/half_edge.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

bool isClosed(const TriangleMesh& mesh) {
  const auto links =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  return links && validate(*links) &&
         std::find(links->twins.begin(), links->twins.end(), kNone) == links->twins.end();
}

/// Without every face that has vertex v.
TriangleMesh without(TriangleMesh mesh, std::uint32_t v) {
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    return t.x == v || t.y == v || t.z == v;
  });
  // The vertex itself would be isolated: the last one takes its place.
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  mesh.positions[v] = mesh.positions[last];
  mesh.positions.pop_back();
  for (glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k)
      t[k] = t[k] == last ? v : t[k];
  }
  return mesh;
}

TEST(CloseHoles, LeavesAClosedMeshAsItIs) {
  const TriangleMesh mesh = primitives::torus(12, 8);
  const auto closed = closeHoles(mesh, {});
  ASSERT_TRUE(closed.has_value());
  EXPECT_EQ(closed->filledHoles, 0U);
  EXPECT_EQ(closed->mesh.triangles, mesh.triangles);
}

TEST(CloseHoles, ClosesSmallOnesAndCountsThem) {
  TriangleMesh mesh = primitives::icosphere(3);
  mesh.triangles.erase(mesh.triangles.begin() + 100);
  mesh = without(mesh, 40);
  mesh = without(mesh, 300);
  const auto closed = closeHoles(mesh, {});
  ASSERT_TRUE(closed.has_value()) << closed.error().message;
  EXPECT_EQ(closed->filledHoles, 3U);
  EXPECT_TRUE(isClosed(closed->mesh));
}

TEST(CloseHoles, UsesAFanWhereEveryEdgeAcrossIsThereAlready) {
  // Moebius' torus of seven vertices, where each is a neighbour of each, without one of them.
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 7; ++i) {
    mesh.positions.emplace_back(100 * i * i % 733, 100 * i, 91 * i * i * i % 677);
    mesh.triangles.emplace_back(i, (i + 1) % 7, (i + 3) % 7);
    mesh.triangles.emplace_back(i, (i + 3) % 7, (i + 2) % 7);
  }
  ASSERT_TRUE(isClosed(mesh));
  const auto closed = closeHoles(without(mesh, 6), {.largestHole = 2.0});
  ASSERT_TRUE(closed.has_value()) << closed.error().message;
  EXPECT_EQ(closed->filledHoles, 1U);
  EXPECT_EQ(closed->mesh.positions.size(), 7U);
  EXPECT_TRUE(isClosed(closed->mesh));
}

TEST(CloseHoles, RefusesWhatIsOpenByNature) {
  const auto closed = closeHoles(primitives::openGrid(10, 10), {});
  ASSERT_FALSE(closed.has_value());
  EXPECT_NE(closed.error().message.find("the mesh is open"), std::string::npos);
}

}  // namespace
}  // namespace limn
