// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/open_surfaces.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace limn {
namespace {

using Back = PolylineSet::Back;

HalfEdgeMesh link(const TriangleMesh& mesh) {
  auto linked =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  EXPECT_TRUE(linked);
  return std::move(*linked);
}

/// Of face 0, as seen along a direction.
Back backOf(const TriangleMesh& shape, const glm::dvec3& forward) {
  const HalfEdgeMesh mesh = link(shape);
  const OpenSurfaces surfaces(mesh, shape.positions, findCracks(mesh, shape.positions));
  return surfaces.backOf(0, {.forward = forward, .orthographic = true});
}

/// A ball without the faces above a height, seen from its middle, as a share of the radius.
TriangleMesh bowl(double height) {
  TriangleMesh ball = primitives::icosphere(4);
  glm::ivec3 low = ball.positions.front();
  glm::ivec3 high = low;
  for (const glm::ivec3& p : ball.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double limit = glm::mix(low.y, high.y, 0.5 * (1.0 + height));
  std::erase_if(ball.triangles, [&](const glm::uvec3& t) {
    return std::max({ball.positions[t.x].y, ball.positions[t.y].y, ball.positions[t.z].y}) > limit;
  });
  return ball;
}

TEST(OpenSurfaces, ABowlShowsItsBackSideFromAboveAndNotFromBelow) {
  EXPECT_EQ(backOf(bowl(0.2), {0.0, -1.0, 0.0}), Back::kSeen);
  EXPECT_EQ(backOf(bowl(0.2), {0.3, -0.9, 0.0}), Back::kSeen);
  EXPECT_EQ(backOf(bowl(0.2), {0.0, 1.0, 0.0}), Back::kMayBeSeen);
  EXPECT_EQ(backOf(bowl(0.2), {1.0, 0.0, 0.0}), Back::kMayBeSeen);
  // Through a hole as small as that of a scan hardly anything is seen.
  EXPECT_EQ(backOf(bowl(0.98), {0.0, -1.0, 0.0}), Back::kMayBeSeen);
}

TEST(OpenSurfaces, ASheetShowsItsBackSideFromBehind) {
  const TriangleMesh sheet = primitives::openGrid(12, 12);
  const glm::ivec3 a = sheet.positions[sheet.triangles[0].x];
  const glm::dvec3 front = glm::cross(
      glm::dvec3(sheet.positions[sheet.triangles[0].y] - a),
      glm::dvec3(sheet.positions[sheet.triangles[0].z] - a));
  EXPECT_EQ(backOf(sheet, glm::normalize(front)), Back::kSeen);
  EXPECT_EQ(backOf(sheet, glm::normalize(-front)), Back::kMayBeSeen);
}

TEST(OpenSurfaces, AClosedSurfaceHasNoBackSideToSee) {
  EXPECT_EQ(backOf(primitives::torus(12, 8), {0.0, -1.0, 0.0}), Back::kNeverSeen);
}

TEST(OpenSurfaces, PartsThatLieAgainstOneAnotherAreOneSurface) {
  TriangleMesh cube = primitives::cube();
  TriangleMesh parts;
  parts.grid = cube.grid;
  for (const glm::uvec3& t : cube.triangles) {
    const auto first = static_cast<std::uint32_t>(parts.positions.size());
    for (int k = 0; k < 3; ++k)
      parts.positions.push_back(cube.positions[t[k]]);
    parts.triangles.emplace_back(first, first + 1, first + 2);
  }
  // One side of the cube alone would be seen from behind.
  for (const double sign : {-1.0, 1.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 forward(0.0);
      forward[axis] = sign;
      EXPECT_EQ(backOf(parts, forward), Back::kMayBeSeen) << axis;
    }
  }
}

TEST(OpenSurfaces, ALineHasTheMostOfTheSurfacesThatItRunsOver) {
  const TriangleMesh shape = bowl(0.2);
  const HalfEdgeMesh mesh = link(shape);
  const OpenSurfaces surfaces(mesh, shape.positions, findCracks(mesh, shape.positions));
  PolylineSet lines;
  lines.points.resize(3);
  lines.faces = {kNone, 0, kNone};
  lines.lines.push_back({.begin = 0, .end = 3});
  surfaces.markBacks({.forward = {0.0, -1.0, 0.0}, .orthographic = true}, lines);
  EXPECT_EQ(lines.lines[0].back, Back::kSeen);
}

}  // namespace
}  // namespace limn
