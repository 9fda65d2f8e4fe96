// SPDX-License-Identifier: Apache-2.0
//
// Silhouette clipping against the truth: the outline of a 500-face hull cut to the mesh's
// silhouette, and that of the mesh itself drawn four times as large and reduced.
#include "client/render/clip_contours.h"
#include "server/preprocess/hulls/build_hull.h"
#include "server/preprocess/maps/normal_map.h"
#include "server/preprocess/maps/png.h"
#include "tests/corpus/corpus.h"
#include "tests/unit/client/render/outline_coverage.h"
#include "tests/unit/client/render/scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr int kSize = 256;
constexpr std::uint32_t kHullFaces = 500;

MeshSnapshot withHull(const TriangleMesh& mesh) {
  MeshSnapshot snapshot = snapshotOf(mesh);
  const auto built = buildHull(mesh, HullSide::kOuter, {.baseFaces = 200});
  EXPECT_TRUE(built) << built.error().message;
  if (built) snapshot.outerHull = std::make_shared<const ProgressiveHull>(built->hull);
  return snapshot;
}

struct Differences {
  outline::Difference coarse;  // from 16 samples a pixel
  outline::Difference fine;    // from 256, of every third view
};

Differences differencesOf(Renderer& renderer, const MeshSnapshot& snapshot, int views) {
  Differences differences;
  for (int view = 0; view < views; ++view) {
    const Camera camera = orbitCamera(
        snapshot.model.sphere,
        360.0 * view / views + 7.0,
        -60.0 + 37.0 * (view % 4),
        view % 3 == 0 ? 2.2 : 4.0,
        40.0);
    RenderOptions clip;
    clip.viewport = {kSize, kSize};
    clip.draw = DrawMode::kClip;
    clip.hullFaces = kHullFaces;
    const PolylineSet lines = silhouetteOf(snapshot, camera, SilhouetteKind::kEdges);
    const auto ours = outline::coverage(renderer, snapshot, lines, camera, clip);
    const auto truth = outline::truth(renderer, snapshot, camera, kSize, 4);
    EXPECT_TRUE(ours && truth);
    if (ours && truth) outline::compare(*ours, *truth, kSize, differences.coarse);
    if (view % 3 != 0) continue;
    const auto fine = outline::truth(renderer, snapshot, camera, kSize, 16);
    EXPECT_TRUE(fine);
    if (ours && fine) outline::compare(*ours, *fine, kSize, differences.fine);
  }
  return differences;
}

class ClipOutline : public ::testing::Test {
 protected:
  void check(const std::string& name, const TriangleMesh& mesh, int views) {
    if (!renderer_) renderer_ = makeRenderer(GlBackend::kOsmesa);
    ASSERT_TRUE(renderer_);
    const Differences d = differencesOf(*renderer_, withHull(mesh), views);
    std::printf(
        "%s: %d leaks, %d holes, outline %.1f grey levels rms from 16 samples a pixel, %.1f from "
        "256\n",
        name.c_str(),
        d.coarse.leaks,
        d.coarse.holes,
        d.coarse.rmsGrey(),
        d.fine.rmsGrey());
    EXPECT_EQ(d.coarse.leaks, 0) << name;
    EXPECT_EQ(d.coarse.holes, 0) << name;
    // Between black and white. Sixteen samples are off by 8 to 11 levels themselves.
    EXPECT_LT(d.coarse.rmsGrey(), 13.0) << name;
    EXPECT_LT(d.fine.rmsGrey(), 3.0) << name;
    EXPECT_GT(d.coarse.edgePixels, 400 * views / 2) << name;
  }

  std::optional<Renderer> renderer_;
};

TEST_F(ClipOutline, OfGeneratedShapesIsThatOfTheMesh) {
  check("bumpy sphere", primitives::bumpySphere(4, 3), 6);
  check("torus", primitives::torus(60, 30), 6);
}

TEST_F(ClipOutline, OfModelsIsThatOfTheMesh) {
  if (!corpus::modelsFolder()) GTEST_SKIP() << corpus::kNoModels;
  for (const char* name : {"bunny-low.off", "fandisk.off"}) {
    const corpus::Mesh* mesh = corpus::model(name);
    if (mesh == nullptr || !mesh->closed) continue;
    check(name, mesh->mesh, 4);
  }
}

/// RMS of how much lighter or darker two pictures are where both show the model, grey levels.
double lightDifference(const Image& a, const Image& b) {
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    if (a.rgba[i + 2] > 245 || b.rgba[i + 2] > 245) continue;  // white paper
    const double d = 1.0 * a.rgba[i + 1] - b.rgba[i + 1];
    squares += d * d;
    ++count;
  }
  return std::sqrt(squares / std::max(count, 1.0));
}

TEST_F(ClipOutline, AMapOfNormalsLightsTheHullAsTheMeshIsLit) {
  const TriangleMesh mesh = primitives::bumpySphere(5, 3);
  MeshSnapshot snapshot = withHull(mesh);
  renderer_ = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer_);
  const Camera camera = orbitCamera(snapshot.model.sphere, 40.0, 20.0, 2.5, 40.0);
  RenderOptions options;
  options.viewport = {kSize, kSize};
  options.paper = glm::vec3(1.0F);
  options.draw = DrawMode::kShaded;
  const auto truth = renderer_->render(snapshot, {}, camera, options);
  const PolylineSet lines = silhouetteOf(snapshot, camera, SilhouetteKind::kEdges);
  options.draw = DrawMode::kClip;
  const auto flat = renderer_->render(snapshot, lines, camera, options);
  const auto level = hullAfter(*snapshot.outerHull, snapshot.outerHull->splitsFor(kHullFaces));
  ASSERT_TRUE(level);
  const NormalMap map = shootNormals(mesh, *level, {.threads = 2});
  snapshot.model.maps = map.layout;
  snapshot.normalMap = std::make_shared<const HullMap>(
      HullMap{map.layout, encodePng(map.layout.width(), map.layout.height(), 2, map.codes)});
  ++snapshot.revision;
  auto fresh = makeRenderer(GlBackend::kOsmesa);
  const auto mapped = fresh->render(snapshot, lines, camera, options);
  ASSERT_TRUE(truth && flat && mapped);
  const double without = lightDifference(flat->image, truth->image);
  const double with = lightDifference(mapped->image, truth->image);
  std::printf("light: %.1f grey levels rms by faces, %.1f by the map\n", without, with);
  EXPECT_LT(with, 0.5 * without);
}

TEST_F(ClipOutline, FromInsideTheHullTheMeshIsDrawn) {
  const MeshSnapshot snapshot = withHull(primitives::torus(60, 30));
  renderer_ = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer_);
  Camera camera = orbitCamera(snapshot.model.sphere, 20.0, 10.0, 0.2, 60.0);  // in the hole
  fitDepthRange(snapshot.model.sphere, camera);
  RenderOptions options;
  options.viewport = {kSize, kSize};
  options.draw = DrawMode::kClip;
  const auto clip = renderer_->render(
      snapshot,
      silhouetteOf(snapshot, camera, SilhouetteKind::kEdges),
      camera,
      options);
  options.draw = DrawMode::kShaded;
  const auto shaded = renderer_->render(snapshot, {}, camera, options);
  ASSERT_TRUE(clip && shaded);
  EXPECT_EQ(clip->image.rgba, shaded->image.rgba);
}

TEST(ClipContours, AnEyeOutsideTheConvexHullIsToldFromOneInside) {
  std::vector<glm::dvec3> cube;
  for (int i = 0; i < 8; ++i)
    cube.emplace_back(i & 1, i >> 1 & 1, i >> 2);
  EXPECT_TRUE(isOutsideConvexHull({2.0, 0.5, 0.5}, cube));
  EXPECT_TRUE(isOutsideConvexHull({1.01, 0.99, 0.99}, cube));
  EXPECT_TRUE(isOutsideConvexHull({1e6, -1e6, 3.0}, cube));
  EXPECT_FALSE(isOutsideConvexHull({0.99, 0.5, 0.5}, cube));
  EXPECT_FALSE(isOutsideConvexHull({0.5, 0.5, 0.5}, cube));
  EXPECT_FALSE(isOutsideConvexHull({1.0, 1.0, 1.0}, cube));
}

TEST(ClipContours, TrianglesHaveTheLoopAsTheirBorder) {
  PolylineSet lines;
  for (int i = 0; i < 11; ++i) {
    const float angle = 0.57F * static_cast<float>(i);
    lines.points.emplace_back(0.5F * std::cos(angle), 0.5F * std::sin(angle), 0.0F);
  }
  lines.lines.push_back({LineKind::kSilhouette, true, 0, 11});
  const auto made = clipContoursOf(lines, {glm::dmat4(1.0), {100, 100}, 8});
  ASSERT_TRUE(made);
  const ClipContours& contours = *made;
  ASSERT_EQ(contours.points.size(), 12U);
  EXPECT_EQ(contours.triangles.size(), 3U * 9U);
  std::vector<int> balance(12 * 12, 0);
  for (std::size_t i = 0; i < contours.triangles.size(); ++i) {
    const std::uint32_t a = contours.triangles[i];
    const std::uint32_t b = contours.triangles[i % 3 == 2 ? i - 2 : i + 1];
    ++balance[a * 12 + b];
    --balance[b * 12 + a];
  }
  for (std::uint32_t a = 0; a < 11; ++a) {
    for (std::uint32_t b = 0; b < 11; ++b) {
      const int expected = b == (a + 1) % 11 ? 1 : a == (b + 1) % 11 ? -1 : 0;
      EXPECT_EQ(balance[a * 12 + b], expected) << a << " " << b;
    }
  }
}

}  // namespace
}  // namespace limn
