// SPDX-License-Identifier: Apache-2.0
#include "client/svg/svg_drawing.h"

#include "client/stroke/chain/chain.h"
#include "client/stroke/drawn_spines.h"
#include "client/stroke/line_halo.h"
#include "client/stroke/parameters.h"
#include "client/stroke/spine.h"
#include "client/stroke/visibility/line_spans.h"
#include "client/stroke/visibility/spine_samples.h"
#include "client/stroke/visibility/visibility.h"
#include "client/svg/clear_runs.h"
#include "client/svg/crowded_runs.h"
#include "client/svg/visible_runs.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace limn {
namespace {

/// A knot, which passes behind itself.
class Drawn {
 public:
  explicit Drawn(TriangleMesh from = primitives::torusKnot(2, 3, 160, 24))
      : shape(std::move(from)) {
    auto built =
        HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
    EXPECT_TRUE(built);
    if (built) mesh = *std::move(built);
    camera = orbitCamera(boundingSphere(shape.grid, shape.positions), 20.0, 15.0);
    const SilhouetteField field(mesh, shape.positions, SilhouetteKind::kSmooth);
    const SilhouetteView view{shape.grid.fromModel(camera.eye), camera.forward(), false};
    SilhouetteChainer chainer;
    lines = chainer.chain(field, view, makeDetector(DetectorMethod::kBrute, field)->detect(view));
    resolved = VisibilityResolver(mesh, shape.positions).resolve(lines, scene());
  }

  [[nodiscard]] LineScene scene() const {
    return {mesh, shape.positions, shape.grid, camera, Viewport{800, 600}};
  }

  [[nodiscard]] ResolveDrawn resolve() const {
    return [this](std::span<const std::uint8_t>) { return resolved; };
  }

  TriangleMesh shape;
  HalfEdgeMesh mesh;
  Camera camera;
  PolylineSet lines;
  ResolvedLines resolved;
};

SvgOptions options() {
  SvgOptions o;
  o.model = "a <torus> & \"more\"";
  o.creator = "test";
  o.visible.color = {1.0F, 0.0F, 0.0F};
  o.hidden = SvgPen{{0.0F, 0.0F, 1.0F}, 0.5F, 1.5F, {4.0F, 2.0F}};
  return o;
}

std::vector<VisibleRun> runsOf(
    const SpineSet& spines,
    const PolylineSet& lines,
    const ResolvedLines& resolved,
    const LineScene& scene) {
  const SpineArcs arcs = measureSpines(spines);
  const SpineSamples samples = sampleSpines(spines, arcs, findSpans(lines, scene), scene.viewport);
  return cutAtVisibility(spines, arcs, lines, resolved, scene, samples, kShortRun);
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(SvgDrawing, HasALayerForEachKindAndVisibilityWithItsLook) {
  const Drawn drawn;
  const std::string svg =
      svgDrawing(drawn.lines, drawn.resolve(), drawn.scene(), StrokeStyle{}, options());
  EXPECT_TRUE(has(svg, "inkscape:groupmode=\"layer\" inkscape:label=\"Silhouettes, visible\""));
  EXPECT_TRUE(has(svg, "stroke=\"#ff0000\" stroke-width=\"2.5\" stroke-linecap=\"round\""));
  EXPECT_TRUE(has(svg, "inkscape:label=\"Silhouettes, hidden\""));
  EXPECT_TRUE(has(svg, "stroke-dasharray=\"4 2\" opacity=\"0.5\""));
  EXPECT_FALSE(has(svg, "Creases"));
  EXPECT_TRUE(has(svg, "<title>a &lt;torus&gt; &amp; &quot;more&quot;</title>"));
  EXPECT_TRUE(has(svg, "viewBox=\"0 0 800 600\""));
}

TEST(SvgDrawing, ALoopThatIsAllVisibleIsOneClosedPath) {
  const Drawn drawn(primitives::icosphere(4));
  const std::string svg =
      svgDrawing(drawn.lines, drawn.resolve(), drawn.scene(), StrokeStyle{}, options());
  EXPECT_EQ(svg.find("<path"), svg.rfind("<path"));
  EXPECT_TRUE(has(svg, "z\"/>"));
}

TEST(SvgDrawing, LeavesHiddenLinesOutWhenTold) {
  const Drawn drawn;
  SvgOptions without = options();
  without.hidden.reset();
  const std::string svg =
      svgDrawing(drawn.lines, drawn.resolve(), drawn.scene(), StrokeStyle{}, without);
  EXPECT_FALSE(has(svg, "hidden"));
  EXPECT_TRUE(has(svg, "<path"));
}

/// The number after `name="`, from `at` on.
double numberOf(const std::string& svg, const std::string& name, std::size_t at) {
  return std::stod(svg.substr(svg.find(name + "=\"", at) + name.size() + 2));
}

TEST(SvgDrawing, DashesGoOnWhereALineComesOutAgain) {
  // A loop's hidden parts all take their dashes from the one texture along it.
  const Drawn drawn;
  SvgOptions dashed = options();
  dashed.visible.dashPx = {4.0F, 2.0F};
  dashed.hidden->dashPx = {4.0F, 2.0F};
  dashed.periodPx = 60.0F;
  const std::string svg =
      svgDrawing(drawn.lines, drawn.resolve(), drawn.scene(), StrokeStyle{}, dashed);
  DrawnSpines stroked;
  stroked.find(drawn.lines, drawn.scene(), StrokeStyle{}, dashed.inkPx);
  SpineSet& spines = stroked.spines;
  smoothSpines(StrokeStyle{}.smoothPx, spines);
  const SpineArcs arcs = measureSpines(spines);
  SpineParameters parameters;
  freshParameters(spines, arcs, drawn.lines, 60.0F, parameters);
  std::size_t checked = 0;
  for (const VisibleRun& run : runsOf(spines, drawn.lines, drawn.resolved, drawn.scene())) {
    const SpineSet::Spine& spine = spines.spines[run.spine];
    const double start = parameters.from[spine.begin];
    const double perPx = (parameters.to[spine.end - 1] - start) / arcs.length[run.spine];
    // Its path starts at the run's first point, to a hundredth of a pixel.
    char begin[64];
    std::snprintf(begin, sizeof begin, "d=\"M%.6g", std::round(100.0 * run.points[0].x) / 100.0);
    const std::size_t path = svg.find(begin);
    if (path == std::string::npos) continue;
    const double offset = numberOf(svg, "stroke-dashoffset", svg.rfind("<path", path));
    const double wanted = std::fmod(start + perPx * run.arc, 6.0) / perPx;
    const double apart = std::abs(offset - wanted);
    EXPECT_LT(std::min(apart, 6.0 / perPx - apart), 0.01);
    ++checked;
  }
  EXPECT_GT(checked, 2U);
}

TEST(SvgDrawing, AShortLineIsThinnerAndNotPaler) {
  // A border over the whole model, and one too short to be drawn in full.
  const Drawn drawn;
  const auto largest = [](const glm::ivec3& a, const glm::ivec3& b) { return a.x < b.x; };
  const std::vector<glm::ivec3>& corners = drawn.shape.positions;
  const glm::vec3 from(*std::min_element(corners.begin(), corners.end(), largest));
  const float length =
      glm::distance(from, glm::vec3(*std::max_element(corners.begin(), corners.end(), largest)));
  PolylineSet lines;
  lines.points = {from, from + glm::vec3(length, 0.0F, 0.0F)};
  const glm::vec3 beside = from + glm::vec3(0.5F * length, 0.1F * length, 0.0F);
  lines.points.insert(
      lines.points.end(),
      {beside, beside + glm::vec3(0.0F, 0.025F * length, 0.0F)});
  lines.halfEdges.assign(4, kNone);
  lines.faces.assign(4, kNone);
  lines.lines = {{LineKind::kBorder, false, 0, 2}, {LineKind::kBorder, false, 2, 4}};
  ResolvedLines resolved;
  resolved.pieces.assign(2, {1.0F, true});
  resolved.begin = {0, 1, 1, 2, 2};
  const std::string svg = svgDrawing(
      lines,
      [&](auto) { return resolved; },
      drawn.scene(),
      StrokeStyle{},
      options());
  const std::size_t path = svg.rfind("<path");
  EXPECT_NE(path, svg.find("<path"));
  EXPECT_LT(numberOf(svg, "stroke-width", path), 0.95 * options().visible.widthPx);
  EXPECT_EQ(svg.find(" opacity=", path), std::string::npos);
}

TEST(SvgDrawing, ADrawingOfNothingIsStillADocument) {
  const Drawn drawn;
  ResolvedLines nothing;
  nothing.begin = {0};
  const std::string svg = svgDrawing(
      PolylineSet{},
      [&](auto) { return nothing; },
      drawn.scene(),
      StrokeStyle{},
      options());
  EXPECT_TRUE(svg.ends_with("</g>\n</svg>\n"));
}

TEST(ClearRuns, HiddenRunsLeaveRoomForVisibleOnes) {
  // A hidden line that crosses a visible one, then runs along it, and another that only runs along.
  const VisibleRun visible{{{10.0F, 50.0F}, {200.0F, 50.0F}}, 0, 0.0F, true, false};
  const VisibleRun crossing{
      {{20.0F, 10.0F}, {20.0F, 80.0F}, {60.0F, 52.0F}, {150.0F, 52.0F}},
      1,
      5.0F,
      false,
      false};
  const VisibleRun beside{{{20.0F, 48.0F}, {190.0F, 48.5F}}, 2, 0.0F, false, false};
  const VisibleRun apart{{{20.0F, 30.0F}, {190.0F, 30.0F}, {190.0F, 20.0F}}, 3, 0.0F, false, true};
  const std::vector<VisibleRun> runs =
      clearOfVisible({visible, crossing, beside, apart}, Viewport{220, 100}, 2.0F);
  ASSERT_EQ(runs.size(), 4U);
  EXPECT_EQ(runs[0].points, visible.points);
  EXPECT_EQ(runs[1].spine, 1U);
  EXPECT_EQ(runs[1].points.front(), crossing.points.front());
  EXPECT_NEAR(runs[1].points.back().y, 50.0F - 2.0F * kHaloWidths, 1.6F);
  EXPECT_EQ(runs[1].points.size(), 2U);
  EXPECT_NEAR(runs[2].points.front().y, 50.0F + 2.0F * kHaloWidths, 1.6F);
  EXPECT_NEAR(runs[2].arc, 5.0F + runs[2].points.front().y - 10.0F, 1e-3F);
  EXPECT_LT(runs[2].points.back().x, 60.0F);
  EXPECT_TRUE(runs[3].closed);
  EXPECT_EQ(runs[3].points, apart.points);
}

TEST(CrowdedRuns, AHiddenRunIsCutWhereItPales) {
  // From open paper in between a hundred others, and out again.
  std::vector<VisibleRun> runs = {{{{10.0F, 150.0F}, {590.0F, 150.0F}}, 0, 7.0F, false, false}};
  for (int i = 0; i < 100; ++i) {
    const float y = 100.0F + static_cast<float>(i);
    runs.push_back({{{250.0F, y}, {350.0F, y}}, 1, 0.0F, false, false});
  }
  const LineDensity density = densityOf(runs, Viewport{600, 300}, false);
  std::vector<VisibleRun> parts;
  cutWherePaler(runs.front(), density, 2.0F, parts);
  ASSERT_GT(parts.size(), 2U);
  EXPECT_EQ(parts.front().points.front(), runs.front().points.front());
  EXPECT_EQ(parts.back().points.back(), runs.front().points.back());
  float palest = 1.0F;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    palest = std::min(palest, crowdingOf(parts[i], false, density, 2.0F).opacity);
    EXPECT_NEAR(parts[i].arc, 7.0F + parts[i].points.front().x - 10.0F, 1e-2F);
    if (i == 0) continue;
    EXPECT_EQ(parts[i].points.front(), parts[i - 1].points.back());
  }
  EXPECT_GT(crowdingOf(parts.front(), false, density, 2.0F).opacity, 0.7F);
  EXPECT_LT(palest, 2.0F * kPalest);
  EXPECT_GT(crowdingOf(runs.front(), false, density, 2.0F).opacity, 3.0F * palest);

  parts.clear();
  cutWherePaler({{{10.0F, 20.0F}, {590.0F, 20.0F}}, 2, 0.0F, false, false}, density, 2.0F, parts);
  EXPECT_EQ(parts.size(), 1U);
}

TEST(VisibleRuns, ABridgeIsVisibleWhereWhatItJoinsIs) {
  // Two lines, the first one's left half hidden, with bridges from its ends to the second.
  const Drawn drawn;
  PolylineSet lines;
  const glm::vec3 right(glm::normalize(glm::cross(drawn.camera.forward(), drawn.camera.up)));
  const auto target = glm::vec3(drawn.shape.grid.fromModel(drawn.camera.target));
  const float unit = 0.2F * glm::distance(glm::vec3(drawn.shape.positions.front()), target);
  for (const float along : {-4.0F, -2.0F, 0.0F, 2.0F, 3.0F, 4.0F})
    lines.points.push_back(target + unit * along * right);
  lines.halfEdges.assign(6, kNone);
  lines.faces.assign(6, kNone);
  lines.lines = {{LineKind::kBorder, false, 0, 4}, {LineKind::kBorder, false, 4, 6}};
  ResolvedLines resolved;
  resolved.pieces = {{1.0F, false}, {1.0F, false}, {1.0F, true}, {1.0F, true}};
  resolved.begin = {0, 1, 2, 3, 3, 4, 4};
  SpineSet spines = projectLines(lines, drawn.scene());
  ASSERT_EQ(spines.spines.size(), 2U);
  const auto bridge = [&](SpineSet::Spine::Joint from, SpineSet::Spine::Joint to) {
    SpineSet::Spine spine;
    spine.joints = {from, to};
    spine.begin = static_cast<std::uint32_t>(spines.points.size());
    for (const std::uint32_t point : {from.point, to.point}) {
      spines.points.push_back(spines.points[point]);
      spines.exact.push_back(spines.points[point]);
      spines.depth.push_back(spines.depth[point]);
      spines.source.push_back(spines.source[point]);
    }
    spine.end = static_cast<std::uint32_t>(spines.points.size());
    spines.spines.push_back(spine);
  };
  bridge({0, 3, true}, {1, 4, false});
  bridge({0, 0, false}, {1, 4, false});
  bridge({1, 5, true}, {0, 0, false});
  std::vector<bool> visible;
  for (const VisibleRun& run : runsOf(spines, lines, resolved, drawn.scene())) {
    if (run.spine >= 2) visible.push_back(run.visible);
  }
  EXPECT_EQ(visible, (std::vector<bool>{true, false, false}));
}

TEST(VisibleRuns, CoverEverySpineAndShareTheirCuts) {
  const Drawn drawn;
  const SpineSet spines = projectLines(drawn.lines, drawn.scene());
  const SpineArcs arcs = measureSpines(spines);
  const auto runs = runsOf(spines, drawn.lines, drawn.resolved, drawn.scene());
  std::vector<float> covered(spines.spines.size(), 0.0F);
  bool someVisible = false;
  bool someHidden = false;
  for (const VisibleRun& run : runs) {
    float length = 0.0F;
    for (std::size_t i = 1; i < run.points.size(); ++i)
      length += glm::distance(run.points[i - 1], run.points[i]);
    if (run.closed) length += glm::distance(run.points.back(), run.points.front());
    EXPECT_GE(length, std::min(2.4F, arcs.length[run.spine] - 0.1F));
    covered[run.spine] += length;
    someVisible = someVisible || run.visible;
    someHidden = someHidden || !run.visible;
  }
  EXPECT_TRUE(someVisible);
  EXPECT_TRUE(someHidden);
  for (std::size_t s = 0; s < covered.size(); ++s)
    EXPECT_NEAR(covered[s], arcs.length[s], 1e-3F * arcs.length[s] + 1e-3F);
  // Runs of one spine follow one another; on a loop the last meets the first.
  for (std::size_t i = 0; i + 1 < runs.size(); ++i) {
    if (runs[i].spine != runs[i + 1].spine) continue;
    EXPECT_LT(glm::distance(runs[i].points.back(), runs[i + 1].points.front()), 1e-3F);
    EXPECT_NE(runs[i].visible, runs[i + 1].visible);
  }
}

}  // namespace
}  // namespace limn
