// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/cracks.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"
#include "shared/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

/// What cracks.h says of every border, each compared with all others.
std::vector<Crack> slowKinds(const HalfEdgeMesh& mesh, const std::vector<glm::ivec3>& positions) {
  struct Border {
    HalfEdgeId edge;
    glm::dvec3 a, b, normal, inwards;
  };

  std::vector<Border> borders;
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (mesh.twin(h) != kNone) continue;
    const glm::dvec3 a(positions[mesh.origin(h)]);
    const glm::dvec3 b(positions[mesh.target(h)]);
    const glm::dvec3 apex(positions[mesh.origin(HalfEdgeMesh::prev(h))]);
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, apex - a));
    borders.push_back({h, a, b, normal, glm::normalize(glm::cross(normal, b - a))});
  }
  const auto kindBetween = [](const Border& here, const Border& there, const glm::dvec3& p) {
    const glm::dvec3 along = there.b - there.a;
    const double t = std::clamp(glm::dot(p - there.a, along) / glm::dot(along, along), 0.0, 1.0);
    if (glm::distance(p, there.a + t * along) > 2.0) return Crack::kNot;
    const auto degrees = [](double cosine) {
      return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
    };
    const double bend = degrees(glm::dot(here.normal, there.normal));
    const double fold = degrees(-glm::dot(here.inwards, there.inwards));
    if (bend > 150.0 || fold > 150.0) return Crack::kNot;
    return bend <= 40.0 && fold <= 40.0 ? Crack::kInvisible : Crack::kCrease;
  };
  const auto kindOf = [&](const Border& here, auto counts) {
    Crack least = Crack::kInvisible;
    for (const double t : {0.2, 0.5, 0.8}) {
      const glm::dvec3 p = here.a + t * (here.b - here.a);
      Crack best = Crack::kNot;
      for (const Border& there : borders) {
        if (&there == &here || !counts(there)) continue;
        const Crack kind = kindBetween(here, there, p);
        if (kind == Crack::kInvisible || best == Crack::kNot) best = kind;
        if (best == Crack::kInvisible) break;
      }
      if (best == Crack::kNot) return best;
      if (best == Crack::kCrease) least = best;
    }
    return least;
  };
  std::vector<Crack> raw(mesh.origins.size(), Crack::kNot);
  for (const Border& border : borders)
    raw[border.edge] = kindOf(border, [](const Border&) { return true; });
  std::vector<Crack> kinds = raw;
  for (const Border& border : borders) {
    if (raw[border.edge] != Crack::kCrease) continue;
    const double own = glm::length(border.b - border.a);
    const auto isOwner = [&](const Border& other) {
      const double length = glm::length(other.b - other.a);
      return raw[other.edge] == Crack::kCrease &&
             (length > own || (length == own && other.edge < border.edge));
    };
    if (kindOf(border, isOwner) != Crack::kNot) kinds[border.edge] = Crack::kInvisible;
  }
  return kinds;
}

/// A mesh cut along many of its edges, the sides a rounding apart; one side of some halved.
Shape cutToPieces(const TriangleMesh& whole, Rng& rng) {
  Shape shape;
  for (const glm::uvec3& t : whole.triangles) {
    std::array<glm::ivec3, 3> corners{};
    for (int k = 0; k < 3; ++k) {
      corners[k] = whole.positions[t[k]];
      if (rng.below(4) == 0) corners[k][rng.below(3)] += 1;
    }
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    shape.positions.insert(shape.positions.end(), corners.begin(), corners.end());
    if (rng.below(3) != 0) {
      shape.triangles.emplace_back(first, first + 1, first + 2);
      continue;
    }
    shape.positions.push_back((corners[0] + corners[1]) / 2);
    shape.triangles.emplace_back(first, first + 3, first + 2);
    shape.triangles.emplace_back(first + 3, first + 1, first + 2);
  }
  return shape;
}

TEST(Cracks, AreThoseFoundByComparingAllBorders) {
  Rng rng(7);
  Shape sheets;  // of very unlike sizes, many meeting at angles
  for (int i = 0; i < 150; ++i) {
    const int size = i % 30 == 0 ? 3000 : 20;
    const auto place = [&] { return 20 * static_cast<int>(rng.below(8)); };
    glm::ivec3 u(0);
    glm::ivec3 v(0);
    const auto axis = static_cast<int>(rng.below(3));
    u[axis] = size;
    v[(axis + 1 + static_cast<int>(rng.below(2))) % 3] = rng.below(2) == 0 ? 20 : -20;
    sheets.addSheet({place(), place(), place() + static_cast<int>(rng.below(2))}, u, v);
  }
  std::array<std::size_t, 3> kinds{};
  for (const Shape& shape :
       {sheets,
        cutToPieces(primitives::cube(), rng),
        cutToPieces(primitives::icosphere(2), rng),
        cutToPieces(primitives::bumpySphere(3, 2), rng)}) {
    const HalfEdgeMesh mesh = shape.link();
    const std::vector<Crack> found = findCracks(mesh, shape.positions).kinds;
    EXPECT_EQ(found, slowKinds(mesh, shape.positions));
    for (const Crack kind : found)
      ++kinds[static_cast<std::size_t>(kind)];
  }
  for (const std::size_t count : kinds)
    EXPECT_GT(count, 50U);
}

}  // namespace
}  // namespace limn
