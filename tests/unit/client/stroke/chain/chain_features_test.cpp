// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/chain.h"

#include "shared/mesh/primitives.h"
#include "shared/progressive/vertex_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace limn {
namespace {

HalfEdgeMesh link(const TriangleMesh& mesh) {
  auto linked =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  EXPECT_TRUE(linked);
  return std::move(*linked);
}

// Each undirected edge of all lines, and that points are where the half-edges say.
std::vector<HalfEdgeId>
edgesOf(const HalfEdgeMesh& mesh, const TriangleMesh& shape, const PolylineSet& set) {
  std::vector<HalfEdgeId> edges;
  for (const PolylineSet::Line& line : set.lines) {
    for (std::uint32_t i = line.begin; i < line.begin + line.segmentCount(); ++i) {
      const std::uint32_t past = i + 1 == line.end ? line.begin : i + 1;
      const HalfEdgeId h = set.halfEdges[i];
      EXPECT_EQ(set.faces[i], HalfEdgeMesh::face(h));
      EXPECT_EQ(set.points[i], glm::vec3(shape.positions[mesh.origin(h)]));
      EXPECT_EQ(set.points[past], glm::vec3(shape.positions[mesh.target(h)]));
      edges.push_back(std::min(h, mesh.twins[h]));
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Creases where faces meet at a right angle.
std::vector<std::uint8_t> rightAngles(const HalfEdgeMesh& mesh, const TriangleMesh& shape) {
  const auto normal = [&](FaceId f) {
    const glm::uvec3& t = mesh.triangles()[f];
    const glm::dvec3 a(shape.positions[t.x]);
    return glm::normalize(
        glm::cross(glm::dvec3(shape.positions[t.y]) - a, glm::dvec3(shape.positions[t.z]) - a));
  };
  std::vector<std::uint8_t> features(mesh.origins.size(), 0);
  for (HalfEdgeId h = 0; h < features.size(); ++h) {
    if (glm::dot(normal(h / 3), normal(mesh.twins[h] / 3)) < 0.5) features[h] = kFeatureCrease;
  }
  return features;
}

TEST(ChainFeatures, ACubeHasTwelveCreasesThatBreakAtItsCorners) {
  const TriangleMesh shape = primitives::cube();
  const HalfEdgeMesh mesh = link(shape);
  const PolylineSet set = chainFeatures(mesh, shape.positions, rightAngles(mesh, shape));
  EXPECT_EQ(set.lines.size(), 12U);
  for (const auto& line : set.lines) {
    EXPECT_EQ(line.kind, LineKind::kCrease);
    EXPECT_FALSE(line.closed);
    EXPECT_EQ(line.segmentCount(), 1U);
  }
  const auto edges = edgesOf(mesh, shape, set);
  EXPECT_EQ(std::set<HalfEdgeId>(edges.begin(), edges.end()).size(), 12U);
}

TEST(ChainFeatures, WithoutCornersACubesCreasesContinue) {
  const TriangleMesh shape = primitives::cube();
  const HalfEdgeMesh mesh = link(shape);
  FeatureChainOptions options;
  options.cornerAngleDegrees = 100.0;
  const PolylineSet set = chainFeatures(mesh, shape.positions, rightAngles(mesh, shape), options);
  EXPECT_EQ(edgesOf(mesh, shape, set).size(), 12U);
  // Three creases meet at each of eight corners: one is left over.
  std::size_t openEnds = 0;
  for (const auto& line : set.lines)
    openEnds += line.closed ? 0 : 2;
  EXPECT_EQ(openEnds, 8U);
}

TEST(ChainFeatures, ABorderRunsWithItsFaceToTheLeftAndBreaksAtCorners) {
  const TriangleMesh shape = primitives::openGrid(10, 6);
  const HalfEdgeMesh mesh = link(shape);
  const PolylineSet set = chainFeatures(mesh, shape.positions, {});
  EXPECT_EQ(set.lines.size(), 4U);
  for (const auto& line : set.lines) {
    EXPECT_EQ(line.kind, LineKind::kBorder);
    EXPECT_FALSE(line.closed);
  }
  for (const HalfEdgeId h : set.halfEdges) {
    if (h != kNone) {
      EXPECT_EQ(mesh.twins[h], kNone);
    }
  }
  EXPECT_EQ(edgesOf(mesh, shape, set).size(), 32U);
  FeatureChainOptions round;
  round.cornerAngleDegrees = 100.0;
  const PolylineSet loop = chainFeatures(mesh, shape.positions, {}, round);
  ASSERT_EQ(loop.lines.size(), 1U);
  EXPECT_TRUE(loop.lines[0].closed);
}

TEST(ChainFeatures, ARingOfCreasesIsOneLoopAndSeamsAreTheirOwnKind) {
  const TriangleMesh shape = primitives::torus(24, 12);
  const HalfEdgeMesh mesh = link(shape);
  std::vector<std::uint8_t> features(mesh.origins.size(), 0);
  // Rings of constant side j: from vertex 12 i + j to 12 (i + 1) + j.
  const auto mark = [&](std::uint32_t j, std::uint8_t bits) {
    for (std::uint32_t i = 0; i < 24; ++i) {
      const HalfEdgeId h = mesh.find(12 * i + j, 12 * ((i + 1) % 24) + j);
      ASSERT_NE(h, kNone);
      features[h] = features[mesh.twins[h]] = bits;
    }
  };
  mark(0, kFeatureCrease);
  mark(3, kFeatureSeam);
  mark(6, kFeatureCrease | kFeatureSeam);
  const PolylineSet set = chainFeatures(mesh, shape.positions, features);
  ASSERT_EQ(set.lines.size(), 3U);
  for (const auto& line : set.lines) {
    EXPECT_TRUE(line.closed);
    EXPECT_EQ(line.segmentCount(), 24U);
  }
  EXPECT_EQ(set.lines[0].kind, LineKind::kCrease);
  EXPECT_EQ(set.lines[1].kind, LineKind::kCrease);
  EXPECT_EQ(set.lines[2].kind, LineKind::kSeam);
}

TEST(ChainFeatures, NothingToChainGivesNothing) {
  const TriangleMesh shape = primitives::icosphere(2);
  const HalfEdgeMesh mesh = link(shape);
  EXPECT_TRUE(chainFeatures(mesh, shape.positions, {}).lines.empty());
  EXPECT_TRUE(chainFeatures({}, {}, {}).lines.empty());
}

TEST(ChainFeatures, ACreaseThatIsCrackedIsOneLineAndNoBorder) {
  // A sheet, and two that stand on its edge, each with corners of its own.
  TriangleMesh shape;
  const auto addSheet = [&](const glm::ivec3& a, const glm::ivec3& u, const glm::ivec3& v) {
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    shape.positions.insert(shape.positions.end(), {a, a + u, a + u + v, a + v});
    shape.triangles.emplace_back(first, first + 1, first + 2);
    shape.triangles.emplace_back(first, first + 2, first + 3);
  };
  addSheet({0, 0, 0}, {1000, 0, 0}, {0, 400, 0});
  addSheet({0, 401, 0}, {1000, 0, 0}, {0, 400, 0});
  addSheet({1001, 0, 0}, {0, 0, 600}, {0, 800, 0});
  const HalfEdgeMesh mesh = link(shape);
  const Cracks cracks = findCracks(mesh, shape.positions);
  const PolylineSet set = chainFeatures(mesh, shape.positions, {}, {.cracks = cracks.kinds});
  std::size_t creases = 0;
  float border = 0.0F;
  for (const PolylineSet::Line& line : set.lines) {
    creases += line.kind == LineKind::kCrease ? line.segmentCount() : 0;
    for (std::uint32_t k = 0; k < line.segmentCount() && line.kind == LineKind::kBorder; ++k)
      border += glm::distance(
          set.points[line.begin + k],
          set.points[line.begin + k + 1 < line.end ? line.begin + k + 1 : line.begin]);
  }
  EXPECT_EQ(creases, 1U);
  EXPECT_NEAR(border, 2.0F * 1000.0F + 800.0F + 2.0F * 600.0F + 800.0F, 8.0F);
}

}  // namespace
}  // namespace limn
