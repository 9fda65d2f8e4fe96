// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/half_edge.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

double signedVolume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x];
    const glm::dvec3 b = mesh.positions[t.y];
    const glm::dvec3 c = mesh.positions[t.z];
    volume += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  return volume;
}

TEST(Primitives, ClosedShapesAreOutwardManifolds) {
  const TriangleMesh shapes[] = {
      primitives::tetrahedron(),
      primitives::cube(),
      primitives::icosphere(3),
      primitives::torus(24, 12),
      primitives::torusKnot(2, 3, 200, 12),
      primitives::bumpySphere(4, 7)};
  for (const TriangleMesh& shape : shapes) {
    const auto mesh =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_TRUE(validate(*mesh));
    EXPECT_EQ(std::count(mesh->twins.begin(), mesh->twins.end(), kNone), 0);
    EXPECT_GT(signedVolume(shape), 0.0);
  }
}

TEST(HalfEdgeMesh, RingOfABorderVertexIsThePathFromBorderToBorder) {
  const TriangleMesh grid = primitives::openGrid(2, 2);
  const auto mesh = HalfEdgeMesh::build(9, grid.triangles);
  ASSERT_TRUE(mesh);
  std::vector<std::uint32_t> ring;
  mesh->ring(1, ring);
  EXPECT_EQ(ring, (std::vector<std::uint32_t>{2, 5, 4, 0}));
  mesh->ring(4, ring);
  EXPECT_EQ(ring.size(), 6U);
  EXPECT_TRUE(mesh->isBorderVertex(1));
  EXPECT_FALSE(mesh->isBorderVertex(4));
}

// A disc of very many sectors is an ordinary CAD export: linking must not be quadratic in valence.
TEST(HalfEdgeMesh, ACentreOfFiftyThousandFacesIsLinked) {
  constexpr std::uint32_t kSectors = 50'000;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t i = 0; i < kSectors; ++i) {
    triangles.emplace_back(0, 1 + i, 1 + (i + 1) % kSectors);
  }
  const auto mesh = HalfEdgeMesh::build(kSectors + 1, triangles);
  ASSERT_TRUE(mesh.has_value());
  EXPECT_TRUE(validate(*mesh).has_value());
  std::vector<std::uint32_t> ring;
  mesh->ring(0, ring);
  EXPECT_EQ(ring.size(), kSectors);
}

TEST(HalfEdgeMesh, FindGivesTheDirectedEdge) {
  const TriangleMesh sphere = primitives::icosphere(2);
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(sphere.positions.size()), sphere.triangles);
  ASSERT_TRUE(mesh);
  for (HalfEdgeId h = 0; h < mesh->origins.size(); ++h) {
    EXPECT_EQ(mesh->find(mesh->origin(h), mesh->target(h)), h);
  }
  EXPECT_EQ(mesh->find(0, 0), kNone);
}

TEST(HalfEdgeMesh, RefusesWhatIsNotManifold) {
  const glm::uvec3 threeOnAnEdge[] = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  EXPECT_FALSE(HalfEdgeMesh::build(5, threeOnAnEdge));
  const glm::uvec3 bowTie[] = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_FALSE(HalfEdgeMesh::build(5, bowTie));
  const glm::uvec3 repeated[] = {{0, 1, 1}};
  EXPECT_FALSE(HalfEdgeMesh::build(2, repeated));
  const glm::uvec3 outside[] = {{0, 1, 2}};
  EXPECT_FALSE(HalfEdgeMesh::build(2, outside));
}

TEST(HalfEdgeMesh, ValidateNoticesABrokenTwin) {
  const TriangleMesh shape = primitives::cube();
  auto mesh = HalfEdgeMesh::build(8, shape.triangles);
  ASSERT_TRUE(mesh);
  std::swap(mesh->twins[0], mesh->twins[1]);
  EXPECT_FALSE(validate(*mesh));
}

}  // namespace
}  // namespace limn
