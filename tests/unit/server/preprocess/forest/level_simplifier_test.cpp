// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/level_simplifier.h"

#include "shared/mesh/feature_edges.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace limn {
namespace {

struct Case {
  const char* name;
  TriangleMesh mesh;
};

std::vector<Case> cases() {
  return {
      {"sphere", primitives::icosphere(4)},
      {"torus", primitives::torus(48, 24)},
      {"bumpy", primitives::bumpySphere(4, 3)},
      {"grid", primitives::openGrid(40, 30)}};
}

LevelSimplifier simplified(const TriangleMesh& mesh, ForestOptions options) {
  auto halfEdges =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  auto features = findCreases(*halfEdges, mesh.positions, options.creaseAngleDegrees);
  LevelSimplifier simplifier(*CollapseMesh::build(mesh, std::move(features)), options);
  simplifier.run();
  return simplifier;
}

// Replays the collapses on the full mesh and checks rule RING from the definition.
TEST(LevelSimplifier, LevelsObeyRuleRing) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const LevelSimplifier simplifier = simplified(c.mesh, {.baseFaces = 60, .threads = 1});
    auto halfEdges =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(c.mesh.positions.size()), c.mesh.triangles);
    CollapseMesh replay =
        *CollapseMesh::build(c.mesh, findCreases(*halfEdges, c.mesh.positions, 40.0));
    std::vector<std::uint32_t> ring;
    for (const CollapseLevel& level : simplifier.levels()) {
      std::set<std::uint32_t> removed;
      std::set<std::uint32_t> parents;
      std::set<std::uint32_t> around;
      for (const HalfEdgeCollapse& collapse : level.collapses) {
        replay.mesh().ring(collapse.removed, ring);
        around.insert(ring.begin(), ring.end());
        EXPECT_TRUE(removed.insert(collapse.removed).second);
        EXPECT_TRUE(parents.insert(collapse.kept).second) << "a parent used twice";
        ASSERT_TRUE(replay.plan(collapse.removed, collapse.kept, collapse.position, -1.0));
        replay.collapse(collapse);
      }
      for (const std::uint32_t v : removed)
        EXPECT_FALSE(around.contains(v)) << "a ring vertex removed";
    }
    EXPECT_EQ(replay.aliveFaces(), simplifier.base().faces);
  }
}

TEST(LevelSimplifier, StopsAtTheFacesAskedFor) {
  for (const std::uint32_t faces : {60U, 200U, 801U, 5000U}) {
    const LevelSimplifier simplifier =
        simplified(primitives::icosphere(4), {.baseFaces = faces, .threads = 1});
    EXPECT_LE(simplifier.base().faces, faces);
    EXPECT_GE(simplifier.base().faces, faces - 1);
  }
}

// A whole level that removed a handful would make closures deep and blocks many.
TEST(LevelSimplifier, LevelsShrinkTheMeshByAFifth) {
  const TriangleMesh mesh = primitives::bumpySphere(5, 3);
  const LevelSimplifier simplifier = simplified(mesh, {.baseFaces = 200, .threads = 1});
  const double ratio =
      static_cast<double>(mesh.positions.size()) / static_cast<double>(simplifier.present().size());
  EXPECT_LE(
      static_cast<double>(simplifier.levels().size()),
      std::log(ratio) / std::log(1.25) + 1.0);
}

TEST(LevelSimplifier, EveryCostKeepsASphereASphere) {
  const TriangleMesh mesh = primitives::icosphere(5);
  double radius = 0.0;
  glm::dvec3 centre(0.0);
  for (const glm::ivec3& p : mesh.positions)
    centre += glm::dvec3(p) / static_cast<double>(mesh.positions.size());
  for (const glm::ivec3& p : mesh.positions)
    radius = std::max(radius, glm::distance(centre, glm::dvec3(p)));
  for (const CollapseCost cost :
       {CollapseCost::kVolume, CollapseCost::kQuadric, CollapseCost::kMemoryless}) {
    const LevelSimplifier simplifier =
        simplified(mesh, {.baseFaces = 500, .cost = cost, .threads = 1});
    // Chords of 500 faces stay within a few percent of the sphere, if faces are of one size.
    EXPECT_LE(simplifier.base().rmsError, 0.02 * radius) << static_cast<int>(cost);
  }
}

// Sharp edges of a cube with finely divided sides: its base mesh is the cube still.
TEST(LevelSimplifier, CreasesAndCornersStay) {
  // A grid over each side, welded: the sphere's pattern is not needed, only exact creases.
  constexpr int kSide = 8;
  constexpr int kStep = 100;
  TriangleMesh mesh;
  std::vector<std::uint32_t> index((kSide + 1) * (kSide + 1) * (kSide + 1), ~0U);
  const auto vertex = [&](glm::ivec3 p) {
    auto& at = index[static_cast<std::size_t>((p.x * (kSide + 1) + p.y) * (kSide + 1) + p.z)];
    if (at == ~0U) {
      at = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(p * kStep);
    }
    return at;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int end = 0; end <= kSide; end += kSide) {
      for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
          const auto corner = [&](int di, int dj) {
            glm::ivec3 p(0);
            p[axis] = end;
            p[(axis + 1) % 3] = i + di;
            p[(axis + 2) % 3] = j + dj;
            return vertex(p);
          };
          glm::uvec3 one(corner(0, 0), corner(1, 0), corner(1, 1));
          glm::uvec3 two(corner(0, 0), corner(1, 1), corner(0, 1));
          if (end == 0) {
            std::swap(one.y, one.z);
            std::swap(two.y, two.z);
          }
          mesh.triangles.push_back(one);
          mesh.triangles.push_back(two);
        }
      }
    }
  }
  for (const CollapseCost cost :
       {CollapseCost::kVolume, CollapseCost::kQuadric, CollapseCost::kMemoryless}) {
    const LevelSimplifier simplifier =
        simplified(mesh, {.baseFaces = 48, .cost = cost, .threads = 1});
    EXPECT_EQ(simplifier.base().faces, 48U);
    double volume = 0.0;
    for (const glm::uvec3& t : simplifier.mesh().mesh().triangles()) {
      const auto& p = simplifier.mesh().positions();
      volume += glm::dot(glm::dvec3(p[t.x]), glm::cross(glm::dvec3(p[t.y]), glm::dvec3(p[t.z])));
    }
    EXPECT_EQ(volume / 6.0, std::pow(kSide * kStep, 3.0)) << static_cast<int>(cost);
  }
}

}  // namespace
}  // namespace limn
