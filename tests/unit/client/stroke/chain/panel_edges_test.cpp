// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/panel_edges.h"

#include "shared/mesh/primitives.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/vertex_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr int kDepth = 2000;
constexpr double kRadius = 2000.0;

HalfEdgeMesh link(const TriangleMesh& mesh) {
  auto linked =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  EXPECT_TRUE(linked);
  return std::move(*linked);
}

/// A band along a course in x and y, kDepth deep.
TriangleMesh band(const std::vector<glm::ivec2>& course) {
  TriangleMesh mesh;
  for (const glm::ivec2& p : course) {
    mesh.positions.emplace_back(p.x, p.y, 0);
    mesh.positions.emplace_back(p.x, p.y, kDepth);
  }
  for (std::uint32_t i = 0; i + 3 < mesh.positions.size(); i += 2) {
    mesh.triangles.emplace_back(i, i + 1, i + 2);
    mesh.triangles.emplace_back(i + 1, i + 3, i + 2);
  }
  return mesh;
}

/// Two panels with a rounding of so many strips between them.
TriangleMesh roundedCorner(int strips, int radius) {
  std::vector<glm::ivec2> course = {{0, 1500}};
  for (int i = 0; i <= strips; ++i) {
    const double angle = std::numbers::pi * (0.5 - 0.5 * i / strips);
    course.emplace_back(
        1500 - radius + std::lround(radius * std::cos(angle)),
        1500 - radius + std::lround(radius * std::sin(angle)));
  }
  course.emplace_back(1500, 0);
  return band(course);
}

/// x of the vertical edges along the band that are creases.
std::vector<int> panelEdges(const TriangleMesh& mesh, double radius = kRadius) {
  const HalfEdgeMesh linked = link(mesh);
  const auto features = withPanelEdges(linked, mesh.positions, {}, radius);
  std::vector<int> found;
  for (HalfEdgeId h = 0; h < features.size(); ++h) {
    if ((features[h] & kFeatureCrease) != 0) found.push_back(mesh.positions[linked.origin(h)].x);
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(PanelEdges, AreWhereARoundingOfNarrowStripsBegins) {
  EXPECT_EQ(panelEdges(roundedCorner(6, 300)), (std::vector{1200, 1500}));
}

TEST(PanelEdges, AreNotInAHollow) {
  TriangleMesh mesh = roundedCorner(6, 300);
  for (glm::uvec3& t : mesh.triangles)
    std::swap(t.y, t.z);
  EXPECT_TRUE(panelEdges(mesh).empty());
}

TEST(PanelEdges, AreNotWithinARounding) {
  // A cylinder's strips are all as wide.
  std::vector<glm::ivec2> course;
  for (int i = 0; i <= 12; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 13.0;
    course.emplace_back(
        std::lround(1000.0 * std::cos(angle)),
        -std::lround(1000.0 * std::sin(angle)));
  }
  EXPECT_TRUE(panelEdges(band(course)).empty());
}

TEST(PanelEdges, AreNotWhereNobodyCouldSeeTheDifference) {
  EXPECT_TRUE(panelEdges(roundedCorner(6, 300), 100.0 * kRadius).empty());
}

TEST(PanelEdges, LeaveOtherFeaturesAsTheyAre) {
  const TriangleMesh mesh = primitives::cube();
  const HalfEdgeMesh linked = link(mesh);
  const std::vector<std::uint8_t> features(linked.origins.size(), kFeatureSeam);
  EXPECT_EQ(withPanelEdges(linked, mesh.positions, features, 1e6), features);
}

}  // namespace
}  // namespace limn
