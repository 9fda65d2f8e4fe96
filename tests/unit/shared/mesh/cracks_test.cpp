// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/cracks.h"

#include "shared/mesh/primitives.h"
#include "shared/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

struct Shape {
  std::vector<glm::ivec3> positions;
  std::vector<glm::uvec3> triangles;

  [[nodiscard]] HalfEdgeMesh link() const {
    auto mesh = HalfEdgeMesh::build(static_cast<std::uint32_t>(positions.size()), triangles);
    EXPECT_TRUE(mesh);
    return std::move(*mesh);
  }

  /// Two triangles: corners a, a + u, a + u + v, a + v.
  void addSheet(const glm::ivec3& a, const glm::ivec3& u, const glm::ivec3& v) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, a + u, a + u + v, a + v});
    triangles.emplace_back(first, first + 1, first + 2);
    triangles.emplace_back(first, first + 2, first + 3);
  }
};

std::size_t count(const std::vector<Crack>& cracks, Crack kind) {
  return static_cast<std::size_t>(std::count(cracks.begin(), cracks.end(), kind));
}

TEST(Cracks, SheetsThatGoOnInOnePlaneHaveNoBorderBetweenThem) {
  Shape shape;
  // One large sheet against two small ones, a grid step away: their corner is on its edge.
  shape.addSheet({0, 0, 0}, {1000, 0, 0}, {0, 800, 0});
  shape.addSheet({1001, 0, 0}, {500, 0, 0}, {0, 300, 0});
  shape.addSheet({1001, 300, 1}, {500, 0, 0}, {0, 500, 0});
  const auto cracks = findCracks(shape.link(), shape.positions).kinds;
  // Three at the line between large and small, two between the small ones.
  EXPECT_EQ(count(cracks, Crack::kInvisible), 5U);
  EXPECT_EQ(count(cracks, Crack::kCrease), 0U);
  EXPECT_EQ(cracks[1], Crack::kInvisible);  // from (1000, 0) to (1000, 800)
}

TEST(Cracks, PartsOfASmoothCrackCoverItFromEitherSide) {
  Shape shape;
  shape.addSheet({0, 0, 0}, {1000, 0, 0}, {0, 800, 0});
  shape.addSheet({1001, 0, 0}, {500, 0, 0}, {0, 300, 0});
  shape.addSheet({1001, 300, 1}, {500, 0, 0}, {0, 500, 0});
  shape.addSheet({0, -1, 0}, {0, 0, -700}, {1000, 0, 0});  // at an angle: no part of it
  const HalfEdgeMesh mesh = shape.link();
  const Cracks found = findCracks(mesh, shape.positions);
  ASSERT_EQ(found.parts.size(), 6U);
  for (const CrackPart& part : found.parts) {
    const auto placeOf = [&](HalfEdgeId h, float t) {
      return glm::mix(
          glm::dvec3(shape.positions[mesh.origin(h)]),
          glm::dvec3(shape.positions[mesh.target(h)]),
          double{t});
    };
    EXPECT_EQ(mesh.twin(part.here), kNone);
    EXPECT_LT(part.begin, part.end);
    EXPECT_LT(
        glm::distance(placeOf(part.here, part.begin), placeOf(part.there, part.beginThere)),
        2.0);
    EXPECT_LT(glm::distance(placeOf(part.here, part.end), placeOf(part.there, part.endThere)), 2.0);
    EXPECT_EQ(
        std::ranges::count_if(
            found.parts,
            [&](const CrackPart& other) {
              return other.here == part.there && other.there == part.here;
            }),
        1);
  }
  // The large sheet's side is covered by the two small ones, one after the other.
  float covered = 0.0F;
  for (const CrackPart& part : found.parts)
    covered += part.here == 1 ? part.end - part.begin : 0.0F;
  EXPECT_NEAR(covered, 1.0F, 1e-5F);
}

TEST(Cracks, SheetsThatMeetAtAnAngleHaveOneCreaseBetweenThem) {
  Shape shape;
  shape.addSheet({0, 0, 0}, {1000, 0, 0}, {0, 800, 0});
  shape.addSheet({1001, 0, 0}, {0, 0, 600}, {0, 400, 0});
  shape.addSheet({1001, 400, 0}, {0, 0, 600}, {0, 400, 0});
  const Cracks found = findCracks(shape.link(), shape.positions);
  const std::vector<Crack>& cracks = found.kinds;
  EXPECT_EQ(count(cracks, Crack::kCrease), 1U);
  EXPECT_GE(found.across[1], 2U);  // a face of the sheets that stand
  EXPECT_EQ(found.across[0], kNone);
  EXPECT_EQ(cracks[1], Crack::kCrease);             // the longest of the three
  EXPECT_EQ(count(cracks, Crack::kInvisible), 4U);  // the others, and between the two
}

TEST(Cracks, BordersOfSheetsBackToBackAndOfPartsApartAreBorders) {
  Shape shape;
  shape.addSheet({0, 0, 0}, {1000, 0, 0}, {0, 800, 0});
  shape.addSheet({0, 0, 1}, {0, 800, 0}, {1000, 0, 0});    // faces the other way
  shape.addSheet({1010, 0, 0}, {500, 0, 0}, {0, 800, 0});  // too far for a crack
  const auto cracks = findCracks(shape.link(), shape.positions).kinds;
  EXPECT_EQ(count(cracks, Crack::kNot), cracks.size());
}

TEST(Cracks, ClosedMeshesAndOpenOnesWithoutCracksHaveNone) {
  for (const TriangleMesh& shape : {primitives::cube(), primitives::openGrid(20, 10)}) {
    const auto mesh =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
    ASSERT_TRUE(mesh);
    const auto cracks = findCracks(*mesh, shape.positions).kinds;
    EXPECT_EQ(count(cracks, Crack::kNot), mesh->origins.size());
  }
}

}  // namespace
}  // namespace limn
