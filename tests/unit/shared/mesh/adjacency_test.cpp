// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/adjacency.h"

#include "shared/mesh/primitives.h"
#include "shared/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>

namespace limn {
namespace {

HalfEdgeMesh meshOf(const TriangleMesh& shape) {
  auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return mesh ? *std::move(mesh) : HalfEdgeMesh{};
}

/// Each face by itself, with corners of its own.
TriangleMesh takenApart(const TriangleMesh& shape) {
  TriangleMesh soup;
  soup.grid = shape.grid;
  for (const glm::uvec3& t : shape.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (int k = 0; k < 3; ++k)
      soup.positions.push_back(shape.positions[t[k]]);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  return soup;
}

/// The places that an index buffer stands for.
std::vector<glm::ivec3> placesOf(
    const std::vector<std::uint32_t>& indices,
    const TriangleMesh& shape) {
  std::vector<glm::ivec3> places;
  for (const std::uint32_t i : indices)
    places.push_back(shape.positions.at(i));
  return places;
}

TEST(Adjacency, CornersAlternateWithWhatLiesAcrossTheirEdges) {
  const TriangleMesh shape = primitives::tetrahedron();
  const HalfEdgeMesh mesh = meshOf(shape);
  const auto indices = trianglesWithAdjacency(mesh, shape.positions);
  ASSERT_EQ(indices.size(), 24U);
  for (std::size_t f = 0; f < 4; ++f) {
    const glm::uvec3& t = shape.triangles[f];
    // Across every edge of a tetrahedron's face lies the one corner that the face has not.
    const std::uint32_t other = 6 - t.x - t.y - t.z;
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(indices[6 * f + 2 * static_cast<std::size_t>(k)], t[k]);
      EXPECT_EQ(indices[6 * f + 2 * static_cast<std::size_t>(k) + 1], other);
    }
  }
}

TEST(Adjacency, FacesOfTheirOwnCornersAreJoinedByPlace) {
  for (const TriangleMesh& shape : {primitives::cube(), primitives::torus(12, 8)}) {
    const TriangleMesh soup = takenApart(shape);
    const auto joined = trianglesWithAdjacency(meshOf(shape), shape.positions);
    const auto matched = trianglesWithAdjacency(meshOf(soup), soup.positions);
    EXPECT_EQ(placesOf(joined, shape), placesOf(matched, soup));
  }
}

TEST(Adjacency, ABorderIsAFaceFoldedOntoItself) {
  const TriangleMesh shape = primitives::openGrid(5, 4);
  const HalfEdgeMesh mesh = meshOf(shape);
  const auto indices = trianglesWithAdjacency(mesh, shape.positions);
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    const std::uint32_t own = mesh.origin(HalfEdgeMesh::prev(h));
    EXPECT_EQ(indices[2 * h + 1] == own, mesh.twin(h) == kNone) << h;
  }
}

TEST(Adjacency, MoreThanTwoFacesAtAPlaceStayApart) {
  // Three fins on one edge, and a pair of faces that both run along it the same way.
  TriangleMesh fins;
  fins.positions = {{0, 0, 0}, {9, 0, 0}, {0, 5, 0}, {0, 0, 0}, {9, 0, 0}, {0, 0, 5}};
  fins.triangles = {{0, 1, 2}, {3, 4, 5}};
  auto indices = trianglesWithAdjacency(meshOf(fins), fins.positions);
  EXPECT_EQ(indices[1], 2U);  // same direction: no neighbours
  EXPECT_EQ(indices[7], 5U);
  fins.positions.insert(fins.positions.end(), {{0, 0, 0}, {9, 0, 0}, {0, -5, 0}});
  fins.triangles.emplace_back(7, 6, 8);
  indices = trianglesWithAdjacency(meshOf(fins), fins.positions);
  EXPECT_EQ(indices[1], 2U);
  EXPECT_EQ(indices[13], 8U);
}

TEST(Adjacency, EveryEdgeOccursOnceWithBothItsOpposites) {
  const TriangleMesh shape = primitives::openGrid(6, 5);
  const HalfEdgeMesh mesh = meshOf(shape);
  const auto edges = edgesWithOpposites(mesh, trianglesWithAdjacency(mesh, shape.positions));
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (std::size_t e = 0; e < edges.size(); e += 4) {
    const auto [low, high] = std::minmax(edges[e], edges[e + 1]);
    EXPECT_TRUE(seen.emplace(low, high).second);
    const HalfEdgeId h = mesh.find(edges[e], edges[e + 1]);
    ASSERT_NE(h, kNone);
    EXPECT_EQ(edges[e + 2], mesh.origin(HalfEdgeMesh::prev(h)));
    const HalfEdgeId twin = mesh.twin(h);
    EXPECT_EQ(edges[e + 3], mesh.origin(HalfEdgeMesh::prev(twin == kNone ? h : twin)));
  }
  std::size_t borders = 0;
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h)
    borders += mesh.twin(h) == kNone ? 1 : 0;
  EXPECT_EQ(2 * seen.size(), mesh.origins.size() + borders);
}

}  // namespace
}  // namespace limn
