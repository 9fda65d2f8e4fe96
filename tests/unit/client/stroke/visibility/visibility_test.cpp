// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/visibility/visibility.h"

#include "client/stroke/chain/chain.h"
#include "client/stroke/visibility/line_spans.h"
#include "client/stroke/visibility/outline_walk.h"

#include "shared/mesh/edge_shape.h"
#include "shared/mesh/primitives.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

/// A depth image with a wall at depth 0.3 over columns [from, to) and nothing elsewhere.
DepthImage wall(int size, int from, int to) {
  DepthImage image{size, size, {}};
  image.depth.assign(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), 1.0F);
  for (int y = 0; y < size; ++y) {
    for (int x = from; x < to; ++x) {
      image.depth
          [static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
           static_cast<std::size_t>(x)] = 0.3F;
    }
  }
  return image;
}

/// Samples at depth 0.5 along the middle row of a picture `size` pixels wide, one a pixel.
SpineSamples row(int size) {
  SpineSamples samples;
  for (int i = 0; i < size; ++i) {
    SpineSample sample;
    sample.position = {(static_cast<float>(i) + 0.5F) / static_cast<float>(size), 0.5F};
    sample.depth = 0.5F;
    sample.bias = 0.01F;
    sample.first = 0.0F;
    sample.last = static_cast<float>(size - 1);
    sample.spanLast = sample.last;
    samples.samples.push_back(sample);
    samples.source.push_back(0);
  }
  samples.begin = {0};
  samples.perPx = {1.0F};
  return samples;
}

TEST(Visibility, ALineBehindAWallIsHiddenExactlyThere) {
  const std::vector<float> visibility = sampleVisibility(row(100), wall(100, 40, 70));
  for (int i = 0; i < 100; ++i) {
    // The 8-neighbourhood sees one pixel past the wall's edges; the filter moves nothing.
    const bool isHidden = i >= 41 && i < 69;
    EXPECT_EQ(visibility[static_cast<std::size_t>(i)] < 0.5F, isHidden) << i;
  }
}

TEST(Visibility, ALineInFrontOfAWallIsVisible) {
  SpineSamples samples = row(100);
  for (SpineSample& sample : samples.samples)
    sample.depth = 0.305F;
  for (const float v : sampleVisibility(samples, wall(100, 40, 70)))
    EXPECT_EQ(v, 1.0F);
}

TEST(Visibility, SpecklesShorterThanTheFilterVanish) {
  // A crack in a wall shows the line for three samples: not a visible stretch.
  DepthImage depth = wall(100, 0, 100);
  for (int y = 0; y < 100; ++y)
    depth.depth[static_cast<std::size_t>(y * 100 + 50)] = 1.0F;
  for (const float v : sampleVisibility(row(100), depth))
    EXPECT_LT(v, 0.5F);
  const std::vector<std::uint8_t> raw = testSamples(row(100), depth);
  EXPECT_EQ(std::count(raw.begin(), raw.end(), 1), 3);
}

TEST(Visibility, GapsAsShortAsAStrokeIsWideAreClosed) {
  // Five samples are hidden for sure, and the line is cut there.
  SpineSamples samples = row(100);
  for (std::size_t i = 0; i < 100; ++i) {
    SpineSample& sample = samples.samples[i];
    if (i >= 40 && i < 45) sample.bias = -1.0F;
    sample.spanFirst = i < 40 ? 0.0F : (i < 45 ? 40.0F : 45.0F);
    sample.spanLast = i < 40 ? 39.0F : (i < 45 ? 44.0F : 99.0F);
  }
  const auto hiddenWith = [&](int closed) {
    const std::vector<float> seen = sampleVisibility(samples, wall(100, 0, 0), closed);
    return std::count_if(seen.begin(), seen.end(), [](float v) { return v < 0.5F; });
  };
  EXPECT_EQ(hiddenWith(kShortRun), 5);
  EXPECT_EQ(hiddenWith(4), 5);
  EXPECT_EQ(hiddenWith(5), 0);
  EXPECT_EQ(hiddenWith(kLongestGap), 0);
  EXPECT_EQ(closedGap(5.2F), 5);
  EXPECT_EQ(closedGap(0.5F), kShortRun);
  EXPECT_EQ(closedGap(50.0F), kLongestGap);
}

TEST(Visibility, ASilhouetteAsksOnlyItsOutwardSide) {
  // The wall begins at column 50; a silhouette at 49.5 with the wall on its inner side is visible,
  // one whose outward side is under the wall is not, although its other side is free.
  SpineSamples samples = row(100);
  for (SpineSample& sample : samples.samples)
    sample.outward = {1.0F, 0.0F};
  std::vector<std::uint8_t> visible = testSamples(samples, wall(100, 50, 100));
  EXPECT_EQ(visible[48], 1);
  EXPECT_EQ(visible[49], 1);  // its own column is free
  EXPECT_EQ(visible[50], 0);
  for (SpineSample& sample : samples.samples)
    sample.outward = {-1.0F, 0.0F};
  visible = testSamples(samples, wall(100, 50, 100));
  EXPECT_EQ(visible[50], 1);
  EXPECT_EQ(visible[51], 0);
}

TEST(Visibility, TheNearestLineIsTheOutlineOfWhatStandsOutALittleFarther) {
  SpineSamples samples = row(100);
  for (SpineSample& sample : samples.samples) {
    sample.outward = {1.0F, 0.0F};
    sample.neededFree = -sample.neededFree;
  }
  samples.farther = 0.02F;  // two pixels
  const std::vector<std::uint8_t> visible = testSamples(samples, wall(100, 20, 50));
  EXPECT_EQ(visible[46], 0);
  EXPECT_EQ(visible[47], 1);  // the wall's last column is 49
  EXPECT_EQ(visible[19], 1);  // it is free where it is, though not farther on
}

TEST(Visibility, WhatIsHiddenByRuleStaysHidden) {
  SpineSamples samples = row(20);
  for (SpineSample& sample : samples.samples)
    sample.bias = -1.0F;
  for (const float v : sampleVisibility(samples, wall(20, 0, 0)))
    EXPECT_EQ(v, 0.0F);
}

TEST(Visibility, ALightsSilhouetteIsHiddenOnlyWhereTheSurfaceTurnsAway) {
  const TriangleMesh shape = primitives::torus(60, 30);
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  ASSERT_TRUE(mesh);
  const Camera camera = orbitCamera(boundingSphere(shape.grid, shape.positions), 20, 40);
  const LineScene scene{*mesh, shape.positions, shape.grid, camera, {400, 400}};
  const SilhouetteField field(*mesh, shape.positions, SilhouetteKind::kSmooth);
  const SilhouetteView light{
      shape.grid.fromModel(camera.eye + glm::dvec3(40.0, 5.0, 1.0)),
      {},
      false};
  SilhouetteChainer chainer;
  PolylineSet lines =
      chainer.chain(field, light, makeDetector(DetectorMethod::kBrute, field)->detect(light));
  for (PolylineSet::Line& line : lines.lines)
    line.onSurface = true;
  const LineSpans spans = findSpans(lines, scene);
  const glm::dvec3 eye = shape.grid.fromModel(camera.eye);
  int shown = 0;
  for (const PolylineSet::Line& line : lines.lines) {
    for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
      const std::uint32_t point = line.begin + k;
      const glm::uvec3& t = shape.triangles[lines.faces[point]];
      const glm::dvec3 a(shape.positions[t.x]);
      const glm::dvec3 n =
          glm::cross(glm::dvec3(shape.positions[t.y]) - a, glm::dvec3(shape.positions[t.z]) - a);
      const bool isFront = glm::dot(n, eye - a) > 0.0;
      const bool isHidden = spans.states[spans.spanAt(point, 0.5F)] == LineSpans::State::kHidden;
      EXPECT_TRUE(isFront || isHidden);
      shown += isFront ? 1 : 0;
    }
  }
  EXPECT_GT(shown, 10);
}

TEST(Visibility, AConcaveEdgeIsHiddenAllAlongWhateverItPassesBehind) {
  const TriangleMesh shape = primitives::torusKnot(3, 7, 300, 12);
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  ASSERT_TRUE(mesh);
  const Camera camera = orbitCamera(boundingSphere(shape.grid, shape.positions), 20, 70);
  const LineScene scene{*mesh, shape.positions, shape.grid, camera, {400, 400}};
  const SilhouetteField field(*mesh, shape.positions, SilhouetteKind::kEdges);
  const SilhouetteView view{shape.grid.fromModel(camera.eye), camera.forward(), false};
  SilhouetteChainer chainer;
  const PolylineSet& lines =
      chainer.chain(field, view, makeDetector(DetectorMethod::kBrute, field)->detect(view));
  const LineSpans spans = findSpans(lines, scene);
  int concave = 0;
  for (const PolylineSet::Line& line : lines.lines) {
    for (std::uint32_t k = 0; k < line.segmentCount(); ++k) {
      const std::uint32_t point = line.begin + k;
      if (!isConcave(*mesh, shape.positions, lines.halfEdges[point])) continue;
      ++concave;
      for (std::uint32_t i = spans.begin[point]; i < spans.begin[point + 1]; ++i)
        EXPECT_EQ(spans.states[spans.pieces[i].span], LineSpans::State::kHidden) << point;
    }
  }
  EXPECT_GT(concave, 20);
}

TEST(Visibility, AWalkOverASurfaceTellsWhetherItCoversAPlace) {
  const TriangleMesh shape = primitives::icosphere(3);
  const auto mesh =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(shape.positions.size()), shape.triangles);
  ASSERT_TRUE(mesh);
  const Camera camera = orbitCamera(boundingSphere(shape.grid, shape.positions), 20, 40);
  const LineScene scene{*mesh, shape.positions, shape.grid, camera, {400, 400}};
  const OutlineWalk walk(scene);
  const glm::dvec3 eye = shape.grid.fromModel(camera.eye);
  const auto corner = [&](HalfEdgeId h) { return glm::dvec3(shape.positions[mesh->origin(h)]); };
  const auto isFront = [&](FaceId f) {
    const glm::dvec3 a = corner(3 * f);
    return glm::dot(glm::cross(corner(3 * f + 1) - a, corner(3 * f + 2) - a), eye - a) > 0.0;
  };
  int walks = 0;
  for (FaceId face = 0; face < mesh->faceCount(); ++face) {
    const FaceId from = HalfEdgeMesh::face(mesh->twin(mesh->twin(3 * face) / 3 * 3));
    if (!isFront(face) || !isFront(from)) continue;
    const glm::dvec3 middle =
        (corner(3 * face) + corner(3 * face + 1) + corner(3 * face + 2)) / 3.0;
    const glm::dvec3 step = 10.0 * glm::normalize(eye - middle);
    EXPECT_EQ(walk.covers(from, middle - step, kNone, kNone), OutlineWalk::Answer::kCovers);
    EXPECT_EQ(walk.covers(from, middle + step, kNone, kNone), OutlineWalk::Answer::kLiesBehind);
    EXPECT_EQ(walk.covers(from, middle - step, face, kNone), OutlineWalk::Answer::kLiesBehind);
    ++walks;
  }
  EXPECT_GT(walks, 100);
}

TEST(Visibility, AClosedSpinesFilterWraps) {
  SpineSamples samples = row(40);
  for (SpineSample& sample : samples.samples)
    sample.last = -39.0F;
  // Hidden by rule in two samples at each end of the array: four in a row around the seam, but the
  // seam itself must look like any other place.
  for (const std::size_t i : {0U, 1U, 38U, 39U})
    samples.samples[i].bias = -1.0F;
  const std::vector<float> atSeam = sampleVisibility(samples, wall(40, 0, 0));
  SpineSamples shifted = row(40);
  for (SpineSample& sample : shifted.samples)
    sample.last = -39.0F;
  for (const std::size_t i : {18U, 19U, 20U, 21U})
    shifted.samples[i].bias = -1.0F;
  const std::vector<float> atMiddle = sampleVisibility(shifted, wall(40, 0, 0));
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_FLOAT_EQ(atSeam[(i + 20) % 40], atMiddle[i]) << i;
  }
}

TEST(Visibility, CreasesOfACubeAreVisibleInFrontAndHiddenBehind) {
  const TriangleMesh cube = primitives::cube();
  const auto built =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(cube.positions.size()), cube.triangles);
  ASSERT_TRUE(built);
  const Camera camera = orbitCamera(boundingSphere(cube.grid, cube.positions), 30, 20);
  const LineScene scene{*built, cube.positions, cube.grid, camera, {256, 256}};
  // Every edge of the cube as a line of its own; depth says "nothing in the way".
  PolylineSet lines;
  for (HalfEdgeId h = 0; h < built->origins.size(); ++h) {
    if (built->twin(h) < h) continue;
    const glm::ivec3 d = cube.positions[built->origin(h)] - cube.positions[built->target(h)];
    if ((d.x != 0) + (d.y != 0) + (d.z != 0) != 1) continue;  // a face's diagonal
    const auto begin = static_cast<std::uint32_t>(lines.points.size());
    lines.points.emplace_back(cube.positions[built->origin(h)]);
    lines.points.emplace_back(cube.positions[built->target(h)]);
    lines.halfEdges.insert(lines.halfEdges.end(), {h, kNone});
    lines.faces.insert(lines.faces.end(), {HalfEdgeMesh::face(h), kNone});
    lines.lines.push_back({LineKind::kCrease, false, begin, begin + 2});
  }
  ASSERT_EQ(lines.lines.size(), 12U);
  DepthImage open{256, 256, std::vector<float>(256 * 256, 1.0F)};
  const std::vector<std::uint8_t> visible = segmentVisibility(lines, scene, open);
  // Three edges meet at the far corner, with both faces turned away: hidden whatever the depth.
  EXPECT_EQ(std::count(visible.begin(), visible.end(), 1), 9);
}

}  // namespace
}  // namespace limn
