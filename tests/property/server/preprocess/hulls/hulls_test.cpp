// SPDX-License-Identifier: GPL-3.0-or-later
// GPL because of CGAL's test for self-intersections.
#include "server/preprocess/hulls/hulls.h"

#include "tests/corpus/corpus.h"
#include "tests/property/server/preprocess/hulls/self_crossing.h"
#include "tests/property/winding_number.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace limn {
namespace {

TriangleMesh onGridOf(const TriangleMesh& mesh, const ProgressiveHull& hull) {
  TriangleMesh fine = mesh;
  fine.grid = hull.base.grid;
  for (glm::ivec3& p : fine.positions)
    p *= 1 << (hull.base.grid.bits - mesh.grid.bits);
  return fine;
}

/// A point of the grid within the mesh's box.
glm::ivec3 randomPoint(const TriangleMesh& mesh, Rng& rng) {
  glm::ivec3 low = mesh.positions.front();
  glm::ivec3 high = low;
  for (const glm::ivec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  glm::ivec3 p;
  for (int axis = 0; axis < 3; ++axis)
    p[axis] = low[axis] +
              static_cast<int>(rng.below(static_cast<std::uint32_t>(high[axis] - low[axis] + 1)));
  return p;
}

/// Points of `inner`'s inside, and its vertices, that `outer` does not hold. Winding numbers,
/// exact.
struct Violations {
  std::size_t points = 0;
  std::size_t vertices = 0;
};

bool isNearInside(const WindingNumber& mesh, const glm::ivec3& p) {
  for (int i = 0; i < 27; ++i) {
    const auto winding = mesh.at(p + glm::ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
    if (winding && *winding > 0) return true;
  }
  return false;
}

/// How many of a mesh's vertices have any inside next to them, some of a grid step away. Where a
/// mesh is turned inside out by its own faces there is nothing to enclose, though another part may
/// be a whole step away.
std::size_t countNearInside(TriangleMesh mesh, std::vector<glm::ivec3> vertices) {
  constexpr int kFiner = 32;
  for (glm::ivec3& p : mesh.positions)
    p *= kFiner;
  const WindingNumber within(mesh);
  return static_cast<std::size_t>(std::ranges::count_if(vertices, [&](const glm::ivec3& p) {
    return isNearInside(within, kFiner * p);
  }));
}

Violations violations(const TriangleMesh& inner, const TriangleMesh& outer, std::uint32_t points) {
  const WindingNumber within(inner);
  const WindingNumber around(outer);
  Violations found;
  Rng rng(17);
  std::vector<glm::ivec3> box(inner.positions);
  box.insert(box.end(), outer.positions.begin(), outer.positions.end());
  const TriangleMesh both{inner.grid, box, {}};
  for (std::uint32_t i = 0; i < points; ++i) {
    const glm::ivec3 p = randomPoint(both, rng);
    const auto in = within.at(p);
    if (!in || *in <= 0) continue;
    const auto out = around.at(p);
    if (out && *out < *in) ++found.points;  // on the surface is not outside
  }
  std::vector<glm::ivec3> outside;
  for (const glm::ivec3& p : inner.positions) {
    const auto out = around.at(p);
    if (out && *out <= 0 && isNearInside(within, p)) outside.push_back(p);
  }
  if (!outside.empty()) found.vertices = countNearInside(inner, outside);
  return found;
}

/// Levels from the base up to the finest, a few.
std::vector<std::size_t> levelsOf(const ProgressiveHull& hull) {
  std::vector<std::size_t> levels;
  for (std::size_t n = 0; n < hull.splits.size(); n = 6 * n + 150)
    levels.push_back(n);
  levels.push_back(hull.splits.size());
  return levels;
}

/// Outer levels hold the mesh, and each the next finer one; inner levels the other way round.
void expectNested(const std::string& name, const TriangleMesh& mesh, std::uint32_t points) {
  const Hulls hulls = buildHulls(mesh, {}, 1);
  ASSERT_TRUE(hulls.outer && hulls.inner) << name << ": " << hulls.reason;
  for (const bool isOuter : {true, false}) {
    const ProgressiveHull& hull = (isOuter ? hulls.outer : hulls.inner)->hull;
    const TriangleMesh original = onGridOf(mesh, hull);
    TriangleMesh finer = original;
    const std::vector<std::size_t> levels = levelsOf(hull);
    for (auto it = levels.rbegin(); it != levels.rend(); ++it) {
      const auto level = hullAfter(hull, *it);
      ASSERT_TRUE(level.has_value()) << level.error().message;
      for (const TriangleMesh* other : {&original, static_cast<const TriangleMesh*>(&finer)}) {
        const Violations found =
            isOuter ? violations(*other, *level, points) : violations(*level, *other, points);
        EXPECT_EQ(found.points, 0U) << name << " at " << level->triangles.size();
        EXPECT_EQ(found.vertices, 0U) << name << " at " << level->triangles.size();
      }
      finer = *level;
    }
  }
}

TEST(ProgressiveHull, LevelsEncloseTheMeshAndOneAnotherOnGeneratedShapes) {
  for (const corpus::Mesh& mesh : corpus::generated()) {
    if (mesh.closed && mesh.mesh.triangles.size() < 6000) expectNested(mesh.name, mesh.mesh, 1500);
  }
}

TEST(ProgressiveHull, LevelsEncloseRealModels) {
  if (!corpus::modelsFolder()) GTEST_SKIP() << corpus::kNoModels;
  // LIMN_ALL_HULLS: every closed model, or the one of that name, 100,000 points a level; an hour.
  if (const char* which = std::getenv("LIMN_ALL_HULLS"); which != nullptr) {
    for (const corpus::Mesh* mesh : corpus::closedMeshes(corpus::Size::kAll)) {
      if (std::string(which) != "1" && mesh->name != which) continue;
      std::printf("%s, %zu faces\n", mesh->name.c_str(), mesh->mesh.triangles.size());
      std::fflush(stdout);
      expectNested(mesh->name, mesh->mesh, 100'000);
    }
    return;
  }
  for (const char* name : {"block.off", "toybrick.stl"}) {
    if (const corpus::Mesh* mesh = corpus::model(name)) expectNested(name, mesh->mesh, 1500);
  }
}

TEST(ProgressiveHull, DoesNotCrossItselfWhereTheMeshDoesNot) {
  for (const TriangleMesh& mesh :
       {primitives::torusKnot(2, 3, 120, 12), primitives::bumpySphere(4, 3)}) {
    ASSERT_FALSE(crossesItself(mesh));
    for (const HullSide side : {HullSide::kOuter, HullSide::kInner}) {
      const auto built = buildHull(mesh, side, {});
      ASSERT_TRUE(built.has_value());
      const ProgressiveHull& hull = built->hull;
      for (const std::uint32_t faces : {built->cleanFaces, 500U, 1000U}) {
        const auto level = hullAfter(hull, hull.splitsFor(std::max(faces, built->cleanFaces)));
        ASSERT_TRUE(level.has_value());
        EXPECT_FALSE(crossesItself(*level)) << faces;
      }
    }
  }
}

TEST(ProgressiveHull, GrowsFromLevelToLevelAndEndsAtTheMesh) {
  const TriangleMesh mesh = primitives::bumpySphere(4, 1);
  const auto built = buildHull(mesh, HullSide::kOuter, {});
  ASSERT_TRUE(built.has_value());
  const ProgressiveHull& hull = built->hull;
  EXPECT_LE(hull.base.triangles.size(), 200U);
  double last = 1e300;
  for (const std::size_t n : levelsOf(hull)) {
    const auto level = hullAfter(hull, n);
    ASSERT_TRUE(level.has_value());
    EXPECT_EQ(level->triangles.size(), hull.facesAfter(n));
    EXPECT_LT(volume6(*level), last);
    last = volume6(*level);
  }
  EXPECT_EQ(hull.facesAfter(hull.splits.size()), mesh.triangles.size());
  EXPECT_NEAR(last, 64.0 * volume6(mesh), 1e-9 * last);
}

TEST(ProgressiveHull, IsTheSameWhateverTheUnits) {
  TriangleMesh mesh = primitives::bumpySphere(3, 2);
  const auto built = buildHull(mesh, HullSide::kOuter, {});
  mesh.grid.step *= 1e-6;
  mesh.grid.origin += glm::dvec3(1e3);
  const auto scaled = buildHull(mesh, HullSide::kOuter, {});
  ASSERT_TRUE(built && scaled);
  EXPECT_EQ(built->hull.base.positions, scaled->hull.base.positions);
  ASSERT_EQ(built->hull.splits.size(), scaled->hull.splits.size());
  for (std::size_t i = 0; i < built->hull.splits.size(); ++i)
    EXPECT_EQ(built->hull.splits[i].addedPosition, scaled->hull.splits[i].addedPosition);
}

TEST(ProgressiveHull, LeavesASmallMeshAsItIs) {
  const auto built = buildHull(primitives::cube(), HullSide::kOuter, {});
  ASSERT_TRUE(built.has_value());
  EXPECT_EQ(built->hull.base.triangles.size(), 12U);
  EXPECT_TRUE(built->hull.splits.empty());
}

TEST(Hulls, SayWhyThereAreNone) {
  const Hulls hulls = buildHulls(primitives::openGrid(20, 20), {}, 1);
  EXPECT_FALSE(hulls.outer.has_value());
  EXPECT_NE(hulls.reason.find("the mesh is open"), std::string::npos);
}

}  // namespace
}  // namespace limn
