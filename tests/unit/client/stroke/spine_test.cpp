// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/spine.h"

#include "tests/unit/client/stroke/flat_view.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace limn {
namespace {

PolylineSet lineOf(std::vector<glm::vec3> points, bool closed) {
  PolylineSet set;
  set.points = std::move(points);
  set.halfEdges.assign(set.points.size(), kNone);
  set.faces.assign(set.points.size(), kNone);
  set.lines.push_back(
      {LineKind::kCrease, closed, 0, static_cast<std::uint32_t>(set.points.size())});
  return set;
}

TEST(Spine, PointsLandOnTheirPixelsWithYDown) {
  const FlatView view;
  const SpineSet spines = projectLines(lineOf({{-50, 20, 0}, {50, 20, 0}}, false), view.scene());
  ASSERT_EQ(spines.spines.size(), 1U);
  EXPECT_NEAR(spines.points[0].x, 50.0F, 1e-3F);
  EXPECT_NEAR(spines.points[0].y, 80.0F, 1e-3F);
  EXPECT_NEAR(spines.points[1].x, 150.0F, 1e-3F);
  EXPECT_TRUE(spines.spines[0].freeStart);
  EXPECT_TRUE(spines.spines[0].freeEnd);
}

TEST(Spine, PartOutsideThePictureIsCutAndItsEndIsNotFree) {
  const FlatView view;
  const SpineSet spines = projectLines(lineOf({{0, 0, 0}, {1000, 0, 0}}, false), view.scene());
  ASSERT_EQ(spines.spines.size(), 1U);
  EXPECT_TRUE(spines.spines[0].freeStart);
  EXPECT_FALSE(spines.spines[0].freeEnd);
  EXPECT_NEAR(spines.points.back().x, 200.0 * (1.0 + kSpineMargin), 0.01);
}

TEST(Spine, LoopLeavingThePictureBecomesPiecesThatNeverBreakInside) {
  const FlatView view;
  // A diamond whose left and right corners are outside, started at its bottom, inside.
  const SpineSet spines = projectLines(
      lineOf({{0, -40, 0}, {300, 0, 0}, {0, 40, 0}, {-300, 0, 0}}, true),
      view.scene());
  ASSERT_EQ(spines.spines.size(), 2U);
  for (const SpineSet::Spine& spine : spines.spines) {
    EXPECT_FALSE(spine.closed);
    EXPECT_FALSE(spine.freeStart);
    EXPECT_FALSE(spine.freeEnd);
    EXPECT_EQ(spine.size(), 3U);  // cut, corner, cut
  }
}

TEST(Spine, LineThroughTheEyeIsCutAtTheNearPlane) {
  FlatView view;
  view.camera.orthographic = false;
  const SpineSet spines = projectLines(lineOf({{0, 0, 0}, {5, 5, 900}}, false), view.scene());
  ASSERT_EQ(spines.spines.size(), 1U);
  EXPECT_FALSE(spines.spines[0].freeEnd);
  for (const glm::vec2& p : spines.points) {
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
    EXPECT_LE(std::abs(p.x - 100.0F), 121.0F);
  }
}

TEST(Spine, LineBehindTheEyeGivesNothing) {
  FlatView view;
  view.camera.orthographic = false;
  EXPECT_TRUE(projectLines(lineOf({{0, 0, 400}, {5, 5, 900}}, false), view.scene()).spines.empty());
}

TEST(Spine, SmoothingFlattensZigZagButLeavesLongEdgesAndEnds) {
  const FlatView view;
  std::vector<glm::vec3> points;
  for (int i = 0; i <= 100; ++i)
    points.emplace_back(i - 50, i % 2 == 0 ? 0.4F : -0.4F, 0);
  SpineSet zigZag = projectLines(lineOf(points, false), view.scene());
  smoothSpines(1.5F, zigZag);
  for (std::size_t i = 8; i < 92; ++i)
    EXPECT_NEAR(zigZag.points[i].y, 100.0F, 0.1F) << i;
  EXPECT_EQ(zigZag.points.front(), zigZag.exact.front());
  EXPECT_EQ(zigZag.points.back(), zigZag.exact.back());

  SpineSet square = projectLines(
      lineOf({{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}}, true),
      view.scene());
  smoothSpines(1.5F, square);
  EXPECT_EQ(square.points, square.exact);
}

TEST(Spine, SmoothingLeavesCuspsWhereTheyAre) {
  // There and back again, 2 px beside itself at first: what turns back at 60 ends there.
  SpineSet line;
  for (int x = 0; x <= 60; ++x)
    line.points.emplace_back(static_cast<float>(x), 0.0F);
  for (int x = 59; x >= 0; --x)
    line.points.emplace_back(static_cast<float>(x), 0.03F * static_cast<float>(60 - x));
  line.exact = line.points;
  line.spines.resize(1);
  line.spines[0].end = static_cast<std::uint32_t>(line.points.size());
  smoothSpines(1.5F, line);
  EXPECT_EQ(line.points[60], glm::vec2(60.0F, 0.0F));
}

TEST(Spine, ArcsOfALoopIncludeItsLastSegment) {
  const FlatView view;
  const SpineSet square = projectLines(
      lineOf({{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}}, true),
      view.scene());
  const SpineArcs arcs = measureSpines(square);
  ASSERT_EQ(arcs.length.size(), 1U);
  EXPECT_NEAR(arcs.length[0], 400.0F, 0.01F);
  EXPECT_NEAR(arcs.arc[3], 300.0F, 0.01F);
}

}  // namespace
}  // namespace limn
