// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/drawn_spines.h"

#include "client/stroke/bridges.h"
#include "client/stroke/fold_backs.h"
#include "client/stroke/visibility/line_spans.h"
#include "client/stroke/visibility/spine_samples.h"
#include "tests/unit/client/stroke/flat_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace limn {
namespace {

/// One face that looks up in the picture: contours on it are to be seen where they run to the left,
/// and hidden by it where they run to the right.
struct Ceiling : FlatView {
  Ceiling() {
    positions = {{0, 0, 0}, {0, 0, 10}, {10, 0, 0}};
    const std::vector<glm::uvec3> triangles = {{0, 1, 2}};
    mesh = *HalfEdgeMesh::build(3, triangles);
  }
};

/// Smooth silhouettes on the ceiling, with a point every pixel.
struct Contours {
  PolylineSet lines;

  void begin() {
    PolylineSet::Line line;
    line.begin = line.end = static_cast<std::uint32_t>(lines.points.size());
    lines.lines.push_back(line);
  }

  /// A straight part, without its end.
  void go(const glm::vec3& from, const glm::vec3& to) {
    const int steps = static_cast<int>(glm::distance(from, to));
    for (int i = 0; i < steps; ++i)
      add(glm::mix(from, to, static_cast<float>(i) / static_cast<float>(steps)));
  }

  void add(const glm::vec3& point) {
    lines.points.push_back(point);
    lines.halfEdges.push_back(kNone);
    lines.faces.push_back(0);
    lines.lines.back().end = static_cast<std::uint32_t>(lines.points.size());
  }
};

/// There, back behind its own surface, and on: the branches cross at (2, 0), if `slope` leads
/// there.
Contours swallowtail(float tip, float slope) {
  Contours contours;
  contours.begin();
  contours.go({50, 0, 0}, {2.0F - tip, 0, 0});
  const glm::vec3 turn(2.0F + tip, slope * tip, 0);
  contours.go({2.0F - tip, 0, 0}, turn);
  contours.go(turn, {2.0F - 50, -50.0F * slope, 0});
  contours.add({2.0F - 50, -50.0F * slope, 0});
  return contours;
}

/// But for less than a pixel, where branches touch before they cross.
bool runsLeft(const SpineSet& spines) {
  float least = spines.points.front().x;
  for (const glm::vec2& p : spines.points) {
    if (p.x > least + 0.7F) return false;
    least = std::min(least, p.x);
  }
  return true;
}

TEST(FoldBacks, AShortSwallowtailIsCutWhereItsBranchesCross) {
  const Ceiling view;
  const Contours contours = swallowtail(3.0F, 0.3F);
  SpineSet spines = projectLines(contours.lines, view.scene());
  const std::size_t before = spines.points.size();
  EXPECT_FALSE(runsLeft(spines));
  cutFoldBacks(contours.lines, view.scene(), 5.0F, spines);
  EXPECT_TRUE(runsLeft(spines));
  EXPECT_LT(spines.points.size(), before);
  EXPECT_EQ(spines.points, spines.exact);
  EXPECT_EQ(spines.spines[0].size(), spines.points.size());
  EXPECT_EQ(spines.source.size(), spines.points.size());
  EXPECT_EQ(spines.depth.size(), spines.points.size());
}

TEST(FoldBacks, OneSwallowtailAfterAnotherIsCut) {
  const Ceiling view;
  Contours contours;
  contours.begin();
  glm::vec3 at(60, 0, 0);
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 tip = at + glm::vec3(-15, 0, 0);
    const glm::vec3 turn = tip + glm::vec3(6, 1, 0);
    const glm::vec3 on = turn + glm::vec3(-15, -2.5F, 0);
    contours.go(at, tip);
    contours.go(tip, turn);
    contours.go(turn, on);
    at = on;
  }
  contours.add(at);
  SpineSet spines = projectLines(contours.lines, view.scene());
  EXPECT_FALSE(runsLeft(spines));
  cutFoldBacks(contours.lines, view.scene(), 7.0F, spines);
  EXPECT_TRUE(runsLeft(spines));
}

TEST(FoldBacks, WhatIsLongOrTurnsOrIsSeenAllAlongStays) {
  const Ceiling view;
  const auto isCut = [&](const Contours& contours) {
    SpineSet spines = projectLines(contours.lines, view.scene());
    const std::size_t before = spines.points.size();
    cutFoldBacks(contours.lines, view.scene(), 5.0F, spines);
    return spines.points.size() != before;
  };
  EXPECT_FALSE(isCut(swallowtail(12.0F, 0.3F)));
  EXPECT_FALSE(isCut(swallowtail(3.0F, 3.0F)));  // a corner
  Contours seen = swallowtail(3.0F, 0.3F);
  seen.lines.lines[0].back = PolylineSet::Back::kSeen;
  EXPECT_FALSE(isCut(seen));
  Contours border = swallowtail(3.0F, 0.3F);
  border.lines.lines[0].kind = LineKind::kBorder;
  EXPECT_FALSE(isCut(border));
}

/// A contour that goes out of sight at (gap, 0, 0), and one that comes out at (0, aside, depth).
Contours broken(float gap, float aside, float depth) {
  Contours contours;
  contours.begin();
  contours.go({60, 0, 0}, {gap, 0, 0});
  contours.go({gap, 0, 0}, {60, -10, 0});
  contours.begin();
  contours.go({-60, aside + 10, depth}, {0, aside, depth});
  contours.go({0, aside, depth}, {-60, aside, depth});
  return contours;
}

TEST(Bridges, AContourGoesOnOverAShortGap) {
  const Ceiling view;
  const Contours contours = broken(8.0F, 1.0F, 0.0F);
  SpineSet spines = projectLines(contours.lines, view.scene());
  std::vector<LineFade> fades = {{1.0F, 0.5F}, {0.25F, 0.5F}};
  bridgeCusps(contours.lines, view.scene(), 13.0F, spines, fades);
  ASSERT_EQ(spines.spines.size(), 3U);
  const SpineSet::Spine& bridge = spines.spines[2];
  ASSERT_TRUE(bridge.isBridge());
  EXPECT_FALSE(bridge.freeStart);
  EXPECT_FALSE(bridge.freeEnd);
  // From one to the other, either way round.
  const auto [low, high] = std::minmax(
      spines.points[bridge.begin],
      spines.points[bridge.end - 1],
      [](const glm::vec2& a, const glm::vec2& b) { return a.x < b.x; });
  EXPECT_NEAR(glm::distance(low, {100, 99}), 0.0F, 1e-3F);
  EXPECT_NEAR(glm::distance(high, {108, 100}), 0.0F, 1e-3F);
  ASSERT_EQ(fades.size(), 3U);
  EXPECT_EQ(fades[2].visible, 0.25F);
  EXPECT_EQ(fades[2].hidden, 0.0F);

  // Its samples ask those of both lines, where they are seen.
  const LineSpans spans = findSpans(contours.lines, view.scene());
  const SpineSamples samples =
      sampleSpines(spines, measureSpines(spines), spans, view.viewport, {});
  for (std::size_t i = samples.begin[2]; i < samples.samples.size(); ++i) {
    const SpineSample& sample = samples.samples[i];
    EXPECT_EQ(sample.neededFree, kAsJoined);
    for (const float joined : {sample.spanFirst, sample.spanLast}) {
      const SpineSample& asked = samples.samples[static_cast<std::size_t>(joined)];
      EXPECT_GE(asked.bias, 0.0F);
      EXPECT_NEAR(std::abs(200.0F * asked.position.x - 104.0F), 6.0F, 1.1F);
    }
  }
}

TEST(Bridges, WhatIsFarOrAsideOrDeepOrTheOtherWayRoundIsNotJoined) {
  const Ceiling view;
  const auto isJoined = [&](const Contours& contours) {
    SpineSet spines = projectLines(contours.lines, view.scene());
    std::vector<LineFade> fades(spines.spines.size());
    bridgeCusps(contours.lines, view.scene(), 13.0F, spines, fades);
    return spines.spines.size() > 2;
  };
  EXPECT_TRUE(isJoined(broken(8.0F, 1.0F, 0.0F)));
  EXPECT_FALSE(isJoined(broken(14.0F, 1.0F, 0.0F)));
  EXPECT_FALSE(isJoined(broken(6.0F, 7.0F, 0.0F)));
  EXPECT_FALSE(isJoined(broken(8.0F, 1.0F, -100.0F)));
  Contours suggestion = broken(8.0F, 1.0F, 0.0F);
  suggestion.lines.lines[1].kind = LineKind::kRidge;
  suggestion.lines.lines[1].onSurface = true;
  EXPECT_FALSE(isJoined(suggestion));
}

TEST(DrawnSpines, LinesTooSmallToBeSeenAreLeftOutAndTheRestIsJoined) {
  const Ceiling view;
  Contours contours = broken(8.0F, 1.0F, 0.0F);
  contours.begin();
  contours.add({20, 60, 0});
  contours.add({21, 60, 0});
  DrawnSpines drawn;
  for (int frame = 0; frame < 2; ++frame) {  // memory is used again
    drawn.find(contours.lines, view.scene(), StrokeStyle{}, 2.6F);
    EXPECT_EQ(drawn.spines.spines.size(), 3U);
    EXPECT_EQ(drawn.fades.size(), 3U);
    EXPECT_EQ(drawn.spines.points.size(), drawn.spines.exact.size());
  }
}

}  // namespace
}  // namespace limn
