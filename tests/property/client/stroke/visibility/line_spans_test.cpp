// SPDX-License-Identifier: Apache-2.0
// Spans against resolved visibility, which is itself held against rays through every face.
#include "client/stroke/visibility/line_spans.h"

#include "client/stroke/chain/chain.h"
#include "client/stroke/visibility/resolved_visibility.h"
#include "client/stroke/visibility/span_segments.h"
#include "client/stroke/visibility/spine_samples.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr std::pair<double, double> kViews[] = {{33.0, 21.0}, {120.0, -35.0}, {250.0, 60.0}};

struct Scene {
  TriangleMesh shape;
  HalfEdgeMesh mesh;
  Camera camera;
  PolylineSet lines;

  Scene(TriangleMesh from, double azimuth, double elevation, SilhouetteKind kind)
      : shape(std::move(from)) {
    auto built =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
    EXPECT_TRUE(built);
    if (!built) return;
    mesh = *std::move(built);
    camera = orbitCamera(boundingSphere(shape.grid, shape.positions), azimuth, elevation, 2.5);
    const SilhouetteField field(mesh, shape.positions, kind);
    const SilhouetteView view{shape.grid.fromModel(camera.eye), camera.forward(), false};
    SilhouetteChainer chainer;
    lines = chainer.chain(field, view, makeDetector(DetectorMethod::kBrute, field)->detect(view));
  }

  [[nodiscard]] LineScene view() const {
    return {mesh, shape.positions, shape.grid, camera, {800, 800}};
  }
};

/// Pieces of lines by what spans and resolved visibility say about them; tiny ones left out, on
/// which rounding may disagree.
struct Count {
  std::size_t pieces = 0;
  std::size_t open = 0;
  std::size_t hiddenButVisible = 0;
  std::size_t surelyHiddenButVisible = 0;
  std::size_t changing = 0;  // pieces unlike another of their span
};

Count compare(const Scene& scene) {
  const LineSpans spans = findSpans(scene.lines, scene.view());
  const VisibilityResolver resolver(scene.mesh, scene.shape.positions);
  const ResolvedLines truth = resolver.resolve(scene.lines, scene.view());
  std::vector<std::optional<bool>> isVisible(spans.states.size());
  Count count;
  for (const PolylineSet::Line& line : scene.lines.lines) {
    for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point) {
      float from = 0.0F;
      for (std::uint32_t i = spans.begin[point]; i < spans.begin[point + 1]; ++i) {
        const LineSpans::Piece& piece = spans.pieces[i];
        const float middle = 0.5F * (from + piece.end);
        const bool isTiny = piece.end - from < 1e-3F;
        from = piece.end;
        if (isTiny) continue;
        bool seen = false;
        for (const ResolvedLines::Piece& part : truth.piecesOf(point)) {
          seen = part.visible;
          // Shares of the picture and of space differ a little across one piece.
          if (middle <= part.end) break;
        }
        ++count.pieces;
        const bool isOpen = spans.states[piece.span] == LineSpans::State::kOpen;
        count.open += isOpen ? 1 : 0;
        count.hiddenButVisible += !isOpen && seen ? 1 : 0;
        const bool isHidden = spans.states[piece.span] == LineSpans::State::kHidden;
        count.surelyHiddenButVisible += isHidden && seen ? 1 : 0;
        std::optional<bool>& first = isVisible[piece.span];
        if (!first) first = seen;
        count.changing += *first != seen ? 1 : 0;
      }
    }
  }
  return count;
}

void expectConstant(const std::string& name, const TriangleMesh& shape) {
  for (const auto& [azimuth, elevation] : kViews) {
    const Count count = compare(Scene(shape, azimuth, elevation, SilhouetteKind::kEdges));
    EXPECT_GT(count.pieces, 100U) << name;
    EXPECT_EQ(count.hiddenButVisible, 0U) << name << " of " << count.pieces;
    EXPECT_EQ(count.changing, 0U) << name << " of " << count.pieces;
    EXPECT_GT(count.open, 0U);
    EXPECT_LT(count.open, count.pieces);
  }
}

TEST(LineSpans, SilhouetteEdgesAreAllVisibleOrAllHiddenBetweenPlacesOfChangeOnAKnot) {
  expectConstant("knot", primitives::torusKnot(2, 3, 160, 20));
}

TEST(LineSpans, SilhouetteEdgesAreAllVisibleOrAllHiddenBetweenPlacesOfChangeOnBumps) {
  expectConstant("bumps", primitives::bumpySphere(4, 3));
}

TEST(LineSpans, SmoothSilhouettesAreDoubtfulWhereTheyPassBehindOthers) {
  const Scene scene(primitives::torusKnot(2, 3, 160, 20), 33.0, 21.0, SilhouetteKind::kSmooth);
  const LineSpans spans = findSpans(scene.lines, scene.view());
  const auto has = [&](LineSpans::State state) {
    return std::count(spans.states.begin(), spans.states.end(), state) > 0;
  };
  EXPECT_TRUE(has(LineSpans::State::kOpen));
  EXPECT_TRUE(has(LineSpans::State::kDoubtful));
  EXPECT_TRUE(has(LineSpans::State::kHidden));
}

TEST(LineSpans, HardlyAnythingOfSmoothSilhouettesIsHiddenForSureThatIsVisible) {
  Count all;
  for (const auto& [azimuth, elevation] : kViews) {
    for (const TriangleMesh& shape :
         {primitives::torusKnot(2, 3, 160, 20), primitives::bumpySphere(5, 3)}) {
      const Count count = compare(Scene(shape, azimuth, elevation, SilhouetteKind::kSmooth));
      all.pieces += count.pieces;
      all.surelyHiddenButVisible += count.surelyHiddenButVisible;
    }
  }
  // Pieces of up to two pixels are asked for in their middle, where resolved visibility may change.
  EXPECT_GT(all.pieces, 2000U);
  EXPECT_LE(500 * all.surelyHiddenButVisible, all.pieces);
}

TEST(LineSpans, WhatIsNotTheNearestLineHasANearerOneBesideIt) {
  const Scene scene(primitives::bumpySphere(5, 3), 33.0, 21.0, SilhouetteKind::kSmooth);
  const LineScene view = scene.view();
  const LineSpans spans = findSpans(scene.lines, view);
  const glm::dmat4 toClip = clipFromGrid(view);
  std::vector<glm::dvec3> from;
  std::vector<glm::dvec3> to;
  std::vector<std::uint32_t> points;
  for (const PolylineSet::Line& line : scene.lines.lines) {
    for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point) {
      const std::uint32_t next = point + 1 < line.end ? point + 1 : line.begin;
      const auto inPicture = [&](std::uint32_t p) {
        return pixelFromClip(toClip * glm::dvec4(scene.lines.points[p], 1.0), view.viewport);
      };
      from.push_back(inPicture(point));
      to.push_back(inPicture(next));
      points.push_back(point);
    }
  }
  // Whether one comes within reach of a place of the other, and is nearer there.
  const auto isBefore = [&](std::size_t other, std::size_t line) {
    for (int k = 0; k <= 20; ++k) {
      const glm::dvec3 place = glm::mix(from[line], to[line], 0.05 * k);
      for (int l = 0; l <= 20; ++l) {
        const glm::dvec3 there = glm::mix(from[other], to[other], 0.05 * l);
        if (there.z < place.z && glm::distance(glm::dvec2(there), glm::dvec2(place)) < 2.6)
          return true;
      }
    }
    return false;
  };
  const auto isHiddenByRule = [&](std::size_t i) {
    return spans.states[spans.pieces[spans.begin[points[i]]].span] == LineSpans::State::kHidden;
  };
  std::size_t nearest = 0;
  std::size_t others = 0;
  std::size_t missed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (isHiddenByRule(i)) continue;
    bool isFirst = true;
    bool isFirstButForOwn = true;
    for (std::size_t other = 0; other < points.size(); ++other) {
      if (other == i || !isBefore(other, i)) continue;
      isFirst = false;
      const bool isOwn = other + 8 > i && other < i + 8;
      if (!isOwn && !isHiddenByRule(other)) isFirstButForOwn = false;
    }
    if (spans.isNearest[points[i]] != 0) {
      ++nearest;
      missed += isFirstButForOwn ? 0 : 1;
    } else {
      ++others;
      EXPECT_FALSE(isFirst) << i;
    }
  }
  EXPECT_GT(nearest, 100U);
  EXPECT_GT(others, 10U);
  // Lines in cells that a segment does not pass through are not looked for.
  EXPECT_LT(3 * missed, others);
}

TEST(LineSpans, LinesThatNobodyWantsHaveNoPieces) {
  const Scene scene(primitives::bumpySphere(4, 3), 33.0, 21.0, SilhouetteKind::kSmooth);
  const std::vector<std::uint8_t> isWanted(scene.lines.points.size(), 0);
  LineSpans spans;
  LineSpanFinder().find(scene.lines, isWanted, scene.view(), spans);
  EXPECT_TRUE(spans.pieces.empty());
  EXPECT_EQ(spans.begin.size(), scene.lines.points.size() + 1);
}

TEST(LineSpans, EverySegmentEndsWithItsLastPiece) {
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    const Scene scene(primitives::bumpySphere(4, 3), 120.0, 20.0, kind);
    const LineSpans spans = findSpans(scene.lines, scene.view());
    ASSERT_EQ(spans.begin.size(), scene.lines.points.size() + 1);
    for (const PolylineSet::Line& line : scene.lines.lines) {
      for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point) {
        ASSERT_LT(spans.begin[point], spans.begin[point + 1]);
        EXPECT_EQ(spans.pieces[spans.begin[point + 1] - 1].end, 1.0F);
      }
    }
  }
}

TEST(LineSpans, MemoryOfTheLastFrameChangesNothing) {
  LineSpanFinder finder;
  LineSpans again;
  for (const auto& [azimuth, elevation] : kViews) {
    const Scene scene(
        primitives::torusKnot(2, 3, 160, 20),
        azimuth,
        elevation,
        SilhouetteKind::kEdges);
    const LineSpans fresh = findSpans(scene.lines, scene.view());
    finder.find(scene.lines, {}, scene.view(), again);
    EXPECT_EQ(again.begin, fresh.begin);
    EXPECT_EQ(again.states, fresh.states);
    ASSERT_EQ(again.pieces.size(), fresh.pieces.size());
    for (std::size_t i = 0; i < fresh.pieces.size(); ++i) {
      EXPECT_EQ(again.pieces[i].end, fresh.pieces[i].end);
      EXPECT_EQ(again.pieces[i].span, fresh.pieces[i].span);
    }
  }
}

// What counts as a segment's own line beside it.
TEST(SpanSegments, ARunOfEdgesIsOfOneLineAndHasNoGap) {
  const Scene scene(primitives::torusKnot(2, 3, 160, 20), 33.0, 21.0, SilhouetteKind::kSmooth);
  PolylineSet shortLines;
  for (PolylineSet::Line line : scene.lines.lines) {
    const std::uint32_t end = line.end;
    for (line.closed = false; line.begin + 4 <= end; line.begin += 4) {
      line.end = line.begin + 4;
      appendLine(scene.lines, line, shortLines);
    }
  }
  std::vector<SegmentFacts> facts(shortLines.points.size());
  SpanSegments segments;
  segments.gather(shortLines, {}, scene.view(), facts);
  std::size_t joined = 0;
  for (std::size_t edge = 1; edge < segments.edgeRun.size(); ++edge) {
    if (segments.edgeRun[edge] != segments.edgeRun[edge - 1]) continue;
    const SpanSegment& before = segments.all[segments.edgeSegment[edge - 1]];
    EXPECT_EQ(before.next, segments.all[segments.edgeSegment[edge]].begin);
    ++joined;
  }
  EXPECT_GT(joined, 50U);
}

}  // namespace
}  // namespace limn
