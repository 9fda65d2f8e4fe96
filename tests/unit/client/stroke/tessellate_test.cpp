// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/tessellate.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

/// One spine in the picture, with everything tessellate() wants.
struct Drawn {
  SpineSet spines;
  SpineArcs arcs;
  SpineSamples samples;
  PolylineSet lines;
};

/// The box around each spine's points, as projection leaves it.
void measureBoxes(SpineSet& spines) {
  for (SpineSet::Spine& spine : spines.spines) {
    spine.low = spine.high = spines.points[spine.begin];
    for (std::uint32_t i = spine.begin; i < spine.end; ++i) {
      spine.low = glm::min(spine.low, spines.points[i]);
      spine.high = glm::max(spine.high, spines.points[i]);
    }
  }
}

Drawn drawn(const std::vector<glm::vec2>& points, bool closed) {
  Drawn d;
  const auto count = static_cast<std::uint32_t>(points.size());
  d.spines.points = points;
  d.spines.exact = points;
  d.spines.depth.assign(count, 0.5F);
  for (std::uint32_t i = 0; i < count; ++i)
    d.spines.source.push_back(i);
  d.spines.spines.push_back({LineKind::kSilhouette, closed, true, true, 0, count, 0});
  measureBoxes(d.spines);
  d.arcs = measureSpines(d.spines);
  d.samples.begin = {0};
  d.samples.perPx = {1.0F};
  d.lines.points.assign(count, glm::vec3(0.0F));
  d.lines.lines.push_back({LineKind::kSilhouette, closed, 0, count});
  return d;
}

StrokeStyle plainStyle() {
  StrokeStyle style;
  style.widthPx = 6.0F;
  style.body = 1.0F;
  style.fadeBelowPx = 0.0F;
  style.fadeHiddenBelowPx = 0.0F;
  return style;
}

/// As seen by the default camera; there is no mesh.
LineScene scene() {
  static const HalfEdgeMesh kNothing;
  static const Grid kGrid;
  static const Camera kCamera;
  return {kNothing, {}, kGrid, kCamera, {512, 512}};
}

StrokeMesh strokes(const Drawn& d, const StrokeStyle& style, const Brush& brush = {}) {
  std::vector<LineFade> fades;
  fadeLines(d.spines, style, scene(), fades);
  SpineParameters parameters;
  freshParameters(d.spines, d.arcs, d.lines, texturePeriod(style, style.widthPx), parameters);
  StrokeMesh mesh;
  tessellate({d.spines, d.arcs, fades, d.samples, parameters}, style, style.widthPx, brush, mesh);
  return mesh;
}

float cross(const glm::vec2& a, const glm::vec2& b) {
  return a.x * b.y - a.y * b.x;
}

bool covers(const StrokeMesh& mesh, const glm::vec2& p) {
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec2 a = mesh.vertices[mesh.indices[i]].position;
    const glm::vec2 b = mesh.vertices[mesh.indices[i + 1]].position;
    const glm::vec2 c = mesh.vertices[mesh.indices[i + 2]].position;
    const float u = cross(b - a, p - a);
    const float v = cross(c - b, p - b);
    const float w = cross(a - c, p - c);
    constexpr float kSlack = 1e-2F;
    if ((u >= -kSlack && v >= -kSlack && w >= -kSlack) ||
        (u <= kSlack && v <= kSlack && w <= kSlack)) {
      return true;
    }
  }
  return false;
}

double area(const StrokeMesh& mesh) {
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec2 a = mesh.vertices[mesh.indices[i]].position;
    const glm::vec2 b = mesh.vertices[mesh.indices[i + 1]].position;
    const glm::vec2 c = mesh.vertices[mesh.indices[i + 2]].position;
    sum += 0.5 * std::abs(cross(b - a, c - a));
  }
  return sum;
}

std::vector<glm::vec2> circle(float radius, int count) {
  std::vector<glm::vec2> points;
  for (int i = 0; i < count; ++i) {
    const float angle =
        2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(count);
    points.push_back(glm::vec2(100.0F) + radius * glm::vec2(std::cos(angle), std::sin(angle)));
  }
  return points;
}

TEST(Strokes, AShortPieceOfALongerLineDoesNotFade) {
  SpineSet spines;
  const auto add = [&](const glm::vec2& from, const glm::vec2& to) {
    SpineSet::Spine spine;
    spine.begin = static_cast<std::uint32_t>(spines.points.size());
    spine.end = spine.begin + 2;
    spine.low = glm::min(from, to);
    spine.high = glm::max(from, to);
    spines.points.insert(spines.points.end(), {from, to});
    spines.depth.insert(spines.depth.end(), {0.5F, 0.5F});
    spines.spines.push_back(spine);
  };
  add({10.0F, 10.0F}, {400.0F, 400.0F});
  add({400.2F, 400.0F}, {403.0F, 402.0F});  // goes on where that ends
  add({200.0F, 20.0F}, {203.0F, 22.0F});    // on its own
  StrokeStyle style;
  style.fadeBelowPx = style.fadeHiddenBelowPx = 6.0F;
  std::vector<LineFade> fades;
  fadeLines(spines, style, scene(), fades);
  EXPECT_EQ(fades[1].visible, 1.0F);
  EXPECT_EQ(fades[1].hidden, 0.0F);  // hidden lines are not to crowd
  EXPECT_EQ(fades[2].visible, 0.0F);
}

TEST(Strokes, FoldsInARowAreOneLine) {
  // Loops one behind the other, so long and wide, with so much between them, beside a long line.
  const auto fadeOf = [](float length, float width, float gap) {
    SpineSet spines;
    const auto add = [&](const std::vector<glm::vec2>& points, bool closed) {
      SpineSet::Spine spine;
      spine.begin = static_cast<std::uint32_t>(spines.points.size());
      spine.end = spine.begin + static_cast<std::uint32_t>(points.size());
      spine.closed = closed;
      spines.points.insert(spines.points.end(), points.begin(), points.end());
      spines.depth.resize(spines.points.size(), 0.5F);
      spines.spines.push_back(spine);
    };
    add({{10.0F, 10.0F}, {500.0F, 400.0F}}, false);
    for (int i = 0; i < 4; ++i) {
      const glm::vec2 at(100.0F + static_cast<float>(i) * (length + gap), 300.0F);
      add({at,
           at + glm::vec2(0.5F * length, width),
           at + glm::vec2(length, 0.0F),
           at + glm::vec2(0.5F * length, -width)},
          true);
    }
    measureBoxes(spines);
    StrokeStyle style;
    style.fadeBelowPx = 10.0F;
    std::vector<LineFade> fades;
    fadeLines(spines, style, scene(), fades);
    return fades[2].visible;
  };
  EXPECT_EQ(fadeOf(8.0F, 0.4F, 1.5F), 1.0F);
  EXPECT_EQ(fadeOf(8.0F, 0.4F, 4.0F), 0.0F);  // apart
  EXPECT_EQ(fadeOf(8.0F, 3.0F, 1.5F), 0.0F);  // bumps
  EXPECT_EQ(fadeOf(3.0F, 0.2F, 1.5F), 0.0F);  // specks
}

TEST(Strokes, CreasesInPiecesSmallerThanAStrokeIsWideAreNoLine) {
  // A zigzag of joined pieces, 40 px from end to end, and a line of 60 px that it ends at.
  const auto fadesOf = [](LineKind kind, float piecePx) {
    SpineSet spines;
    const auto add = [&](const glm::vec2& from, const glm::vec2& to) {
      SpineSet::Spine spine;
      spine.kind = kind;
      spine.begin = static_cast<std::uint32_t>(spines.points.size());
      spine.end = spine.begin + 2;
      spines.points.insert(spines.points.end(), {from, to});
      spines.depth.insert(spines.depth.end(), {0.5F, 0.5F});
      spines.spines.push_back(spine);
    };
    const float step = 0.7F * piecePx;
    for (int i = 0; static_cast<float>(i) * step < 40.0F; ++i) {
      const glm::vec2 from(
          100.0F + static_cast<float>(i) * step,
          i % 2 == 0 ? 100.0F : 100.0F + step);
      add(from, {from.x + step, i % 2 == 0 ? 100.0F + step : 100.0F});
    }
    add(spines.points.back(), spines.points.back() + glm::vec2(60.0F, 0.0F));
    add({10.0F, 10.0F}, {500.0F, 400.0F});
    measureBoxes(spines);
    StrokeStyle style;
    style.fadeBelowPx = 10.0F;
    style.creaseFade = 1.5F;
    std::vector<LineFade> fades;
    fadeLines(spines, style, scene(), fades);
    return std::array{fades[0].visible, fades[fades.size() - 2].visible};
  };
  using Fades = std::array<float, 2>;
  EXPECT_EQ(fadesOf(LineKind::kCrease, 1.2F), (Fades{0.0F, 1.0F}));
  EXPECT_EQ(fadesOf(LineKind::kCrease, 6.0F), (Fades{1.0F, 1.0F}));
  EXPECT_EQ(fadesOf(LineKind::kSilhouette, 1.2F), (Fades{1.0F, 1.0F}));
}

TEST(Strokes, ABumpThatTakesALongOutlinesPlaceDoesNotFade) {
  // A bump 10 px long over an outline; 7 px nearer to the eye unless said otherwise.
  const auto fadeOf = [](float depth, const glm::vec2& shift, bool isTurned, float scale = 1.0F) {
    SpineSet spines;
    spines.points = {{10.0F, 200.0F}, {500.0F, 200.0F}};
    spines.depth = {0.5F, 0.5F};
    std::vector<glm::vec2> bump = {
        {200.0F, 199.0F},
        {205.0F, 200.0F},
        {210.0F, 199.0F},
        {205.0F, 196.0F}};
    if (isTurned)
      bump = {bump[0] - glm::vec2(0.0F, 4.0F), bump[2] - glm::vec2(0.0F, 4.0F), bump[1]};
    for (const glm::vec2& p : bump) {
      spines.points.push_back(glm::vec2(200.0F) + scale * (p - glm::vec2(200.0F)) + shift);
      spines.depth.push_back(depth);
    }
    spines.spines.resize(2);
    spines.spines[0].end = 2;
    spines.spines[1].closed = true;
    spines.spines[1].begin = 2;
    spines.spines[1].end = static_cast<std::uint32_t>(spines.points.size());
    measureBoxes(spines);
    StrokeStyle style;
    style.fadeBelowPx = 12.0F;
    std::vector<LineFade> fades;
    fadeLines(spines, style, scene(), fades);
    EXPECT_EQ(fades[0].visible, 1.0F);
    return fades[1].visible;
  };
  EXPECT_EQ(fadeOf(0.495F, {}, false), 1.0F);
  EXPECT_EQ(fadeOf(0.505F, {}, false), 0.0F);             // behind the outline
  EXPECT_EQ(fadeOf(0.4F, {}, false), 0.0F);               // far before it
  EXPECT_EQ(fadeOf(0.495F, {0.0F, 9.0F}, false), 0.0F);   // beside it
  EXPECT_EQ(fadeOf(0.495F, {0.0F, -2.0F}, false), 0.0F);  // inside: it is to be seen as well
  EXPECT_EQ(fadeOf(0.495F, {0.0F, 2.0F}, false), 1.0F);   // it stands out over it
  EXPECT_EQ(fadeOf(0.495F, {}, false, 0.5F), 1.0F);
  EXPECT_EQ(fadeOf(0.495F, {}, false, 0.2F), 0.0F);  // a blot, no larger than a stroke is wide
  EXPECT_EQ(fadeOf(0.495F, {}, true), 0.0F);         // bounding the other side there
}

TEST(Tessellate, EveryPointNearTheSpineIsCoveredHoweverSharpTheTurns) {
  Rng rng(7);
  for (int round = 0; round < 20; ++round) {
    std::vector<glm::vec2> points = {{50.0F, 50.0F}};
    const bool closed = round % 2 == 1;
    for (int i = 0; i < 12; ++i) {
      // Steps of 2 to 30 px in any direction, straight back included.
      const double angle = i % 5 == 4 ? std::numbers::pi : 2.0 * std::numbers::pi * rng.uniform();
      const double size = 2.0 + 28.0 * rng.uniform();
      points.push_back(points.back() + glm::vec2(size * std::cos(angle), size * std::sin(angle)));
    }
    const Drawn d = drawn(points, closed);
    const StrokeMesh mesh = strokes(d, plainStyle());
    const std::size_t segments = points.size() - (closed ? 0 : 1);
    for (std::size_t i = 0; i < segments; ++i) {
      const glm::vec2 a = points[i];
      const glm::vec2 b = points[(i + 1) % points.size()];
      for (float t = 0.0F; t <= 1.0F; t += 0.125F) {
        const glm::vec2 middle = glm::mix(a, b, t);
        ASSERT_TRUE(covers(mesh, middle)) << "round " << round << " segment " << i << " at " << t;
        const glm::vec2 n = glm::normalize(glm::vec2(a.y - b.y, b.x - a.x));
        // Up to the full width, away from the inner side of corners.
        if (t < 0.4F || t > 0.6F || glm::distance(a, b) < 20.0F) continue;
        ASSERT_TRUE(covers(mesh, middle + 2.9F * n)) << "round " << round << " segment " << i;
        ASSERT_TRUE(covers(mesh, middle - 2.9F * n)) << "round " << round << " segment " << i;
      }
    }
    // Around each corner the outer side is closed: the ring at 0.9 half widths on it has no gap.
    for (std::size_t i = closed ? 0 : 1; i + 1 < points.size(); ++i) {
      const glm::vec2 in =
          glm::normalize(points[i] - points[(i + points.size() - 1) % points.size()]);
      const glm::vec2 out = glm::normalize(points[i + 1] - points[i]);
      const glm::vec2 bisector = in - out;
      if (glm::length(bisector) < 1e-3F) continue;
      ASSERT_TRUE(covers(mesh, points[i] + 2.6F * glm::normalize(bisector)))
          << "round " << round << " corner " << i;
    }
  }
}

TEST(Tessellate, GentleCurvesHaveNeitherGapsNorOverlaps) {
  const Drawn d = drawn(circle(60.0F, 120), true);
  const double expected = std::numbers::pi * (63.0 * 63.0 - 57.0 * 57.0);
  EXPECT_NEAR(area(strokes(d, plainStyle())), expected, 0.005 * expected);
}

TEST(Tessellate, PointsThatAStraightStripPassesAreLeftOut) {
  std::vector<glm::vec2> points;
  for (int i = 0; i <= 40; ++i)
    points.emplace_back(0.5F * static_cast<float>(i), i % 2 == 0 ? 0.0F : 0.05F);
  for (int i = 1; i <= 40; ++i)
    points.emplace_back(20.0F, 0.5F * static_cast<float>(i));
  const StrokeMesh mesh = strokes(drawn(points, false), plainStyle());
  EXPECT_LT(mesh.vertices.size(), 90U);  // of 162, ends included
  for (const glm::vec2& p : points)
    EXPECT_TRUE(covers(mesh, p)) << p.x << " " << p.y;
  EXPECT_TRUE(covers(mesh, {22.0F, -2.0F})) << "the corner stays a corner";
}

TEST(Tessellate, NeighbouringSegmentsShareTheirCornerVertices) {
  const Drawn d = drawn({{0, 0}, {20, 0}, {40, 5}, {60, 5}}, false);
  StrokeStyle style = plainStyle();
  const StrokeMesh mesh = strokes(d, style);
  // A strip of n stations has 2n vertices and n − 1 quads: nothing is duplicated.
  EXPECT_EQ(mesh.indices.size() / 6, mesh.vertices.size() / 2 - 1);
}

TEST(Tessellate, AStraightStrokeHasExactlyItsWidth) {
  const Drawn d = drawn({{10, 10}, {110, 10}}, false);
  const StrokeMesh mesh = strokes(d, plainStyle());
  EXPECT_TRUE(covers(mesh, {60.0F, 12.98F}));
  EXPECT_FALSE(covers(mesh, {60.0F, 13.05F}));
  EXPECT_TRUE(covers(mesh, {60.0F, 7.02F}));
  EXPECT_FALSE(covers(mesh, {60.0F, 6.95F}));
}

TEST(Tessellate, ALoopsTextureClosesAfterAWholeNumberOfRepeats) {
  for (const float radius : {8.0F, 37.0F, 80.0F}) {
    const Drawn d = drawn(circle(radius, 90), true);
    StrokeStyle style = plainStyle();
    style.visible.lengthPx = 70.0F;
    style.hidden.lengthPx = 33.0F;
    const StrokeMesh mesh = strokes(d, style);
    const auto [low, high] = std::minmax_element(
        mesh.vertices.begin(),
        mesh.vertices.end(),
        [](const StrokeVertex& a, const StrokeVertex& b) { return a.visibleU < b.visibleU; });
    const float repeats = high->visibleU - low->visibleU;
    EXPECT_GE(repeats, 0.99F);
    EXPECT_NEAR(repeats, std::round(repeats), 1e-3F) << radius;
    const float hidden = high->hiddenU - low->hiddenU;
    EXPECT_NEAR(hidden, std::round(hidden), 1e-3F) << radius;
    // The seam is at one place in the picture.
    EXPECT_NEAR(glm::distance(low->position, high->position), 0.0F, 6.2F);
  }
}

TEST(Tessellate, OpenEndsTaperAndCutEndsDoNot) {
  Drawn d = drawn({{10, 10}, {110, 10}}, false);
  StrokeStyle style = plainStyle();
  style.taperPx = 20.0F;
  EXPECT_FALSE(covers(strokes(d, style), {12.0F, 12.5F}));
  EXPECT_TRUE(covers(strokes(d, style), {60.0F, 12.5F}));
  d.spines.spines[0].freeStart = false;
  EXPECT_TRUE(covers(strokes(d, style), {10.5F, 12.5F}));
}

TEST(Tessellate, ABrushLeadsTheStripOffItsLineAndKeepsItWhole) {
  for (const BrushKind kind :
       {BrushKind::kCharcoal, BrushKind::kLazy, BrushKind::kHand, BrushKind::kRough}) {
    for (const bool closed : {false, true}) {
      const Drawn d =
          closed ? drawn(circle(60.0F, 90), true) : drawn({{20, 20}, {220, 20}, {220, 160}}, false);
      Brush brush = usualBrush(kind);
      brush.amplitudePx = std::min(brush.amplitudePx, 4.0F);
      const StrokeMesh plain = strokes(d, plainStyle());
      const StrokeMesh led = strokes(d, plainStyle(), brush);
      EXPECT_GT(led.vertices.size(), plain.vertices.size());
      for (const StrokeVertex& v : led.vertices)
        ASSERT_TRUE(std::isfinite(v.position.x) && std::isfinite(v.position.y));
      // One ribbon: each pair of neighbouring triangles meets.
      for (std::size_t i = 3; i < led.indices.size(); i += 3) {
        float nearest = 1e9F;
        for (int a = 0; a < 3; ++a) {
          for (int b = 0; b < 3; ++b) {
            nearest = std::min(
                nearest,
                glm::distance(
                    led.vertices[led.indices[i + a]].position,
                    led.vertices[led.indices[i - 3 + b]].position));
          }
        }
        ASSERT_LT(nearest, 7.0F);
      }
    }
  }
}

/// Two spines: a loop of this radius, and a line far longer.
StrokeMesh loopBesideALongLine(float radius, const StrokeStyle& style) {
  Drawn d = drawn(circle(radius, 24), true);
  d.spines.points.insert(d.spines.points.end(), {{0.0F, 0.0F}, {900.0F, 0.0F}});
  d.spines.exact = d.spines.points;
  d.spines.depth.resize(26, 0.5F);
  d.spines.source.resize(26, 0);
  d.spines.spines.push_back({LineKind::kSilhouette, false, true, true, 24, 26, 0});
  measureBoxes(d.spines);
  d.arcs = measureSpines(d.spines);
  d.samples.begin = {0, 0};
  d.samples.perPx = {1.0F, 1.0F};
  return strokes(d, style);
}

TEST(Tessellate, TinyLoopsFadeAway) {
  StrokeStyle style = plainStyle();
  style.fadeBelowPx = 6.0F;
  style.fadeHiddenBelowPx = 16.0F;
  const std::size_t lineAlone = loopBesideALongLine(1.0F, style).vertices.size();
  const StrokeMesh both = loopBesideALongLine(4.5F, style);
  ASSERT_GT(both.vertices.size(), lineAlone);
  EXPECT_FLOAT_EQ(both.vertices[0].visibleFade, 1.0F);
  EXPECT_FLOAT_EQ(both.vertices[0].hiddenFade, 0.0F);
}

TEST(Tessellate, ASmallModelIsNotFadedAway) {
  StrokeStyle style = plainStyle();
  style.fadeBelowPx = 6.0F;
  const StrokeMesh mesh = strokes(drawn(circle(1.0F, 12), true), style);
  ASSERT_FALSE(mesh.vertices.empty());
  EXPECT_FLOAT_EQ(mesh.vertices[0].visibleFade, 1.0F);
}

TEST(Tessellate, RepeatedPointsAndEmptyInputDoNoHarm) {
  EXPECT_TRUE(strokes(drawn({{5, 5}, {5, 5}}, false), plainStyle()).vertices.empty());
  const StrokeMesh mesh = strokes(drawn({{5, 5}, {25, 5}, {25, 5}, {45, 5}}, false), plainStyle());
  for (const StrokeVertex& v : mesh.vertices) {
    EXPECT_TRUE(std::isfinite(v.position.x) && std::isfinite(v.position.y));
  }
  EXPECT_TRUE(covers(mesh, {25.0F, 7.0F}));
}

}  // namespace
}  // namespace limn
