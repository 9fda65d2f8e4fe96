// SPDX-License-Identifier: Apache-2.0
//
// Silhouette clipping against the truth: the outline of a 500-face hull cut to the mesh's
// silhouette, and that of the mesh itself drawn four times as large and reduced.
#include "client/render/clip_contours.h"
#include "client/render/scene.h"
#include "server/preprocess/hulls/build_hull.h"
#include "server/preprocess/maps/hull_maps.h"
#include "server/preprocess/maps/png.h"
#include "tests/corpus/corpus.h"
#include "tests/unit/client/render/outline_coverage.h"
#include "tests/unit/client/render/scene_fixture.h"

#include "shared/core/rng.h"

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
  const HullMaps map = shootMaps(mesh, *level, {.threads = 2});
  snapshot.model.maps = map.layout;
  snapshot.normalMap = std::make_shared<const HullMap>(
      HullMap{map.layout, encodePng(map.layout.width(), map.layout.height(), 2, map.normals)});
  ++snapshot.revision;
  auto fresh = makeRenderer(GlBackend::kOsmesa);
  const auto mapped = fresh->render(snapshot, lines, camera, options);
  ASSERT_TRUE(truth && flat && mapped);
  const double without = lightDifference(flat->image, truth->image);
  const double with = lightDifference(mapped->image, truth->image);
  std::printf("light: %.1f grey levels rms by faces, %.1f by the map\n", without, with);
  EXPECT_LT(with, 0.5 * without);
}

TEST_F(ClipOutline, AMapOfColoursPaintsTheHullAsTheMeshIsPainted) {
  TriangleMesh mesh = primitives::bumpySphere(5, 3);
  for (const glm::ivec3& p : mesh.positions)
    mesh.attributes.colors.emplace_back(p.x / 64, 255 - p.y / 64, p.z / 64);
  MeshSnapshot snapshot = withHull(mesh);
  const auto level = hullAfter(*snapshot.outerHull, snapshot.outerHull->splitsFor(kHullFaces));
  ASSERT_TRUE(level);
  const HullMaps map = shootMaps(mesh, *level, {.threads = 2});
  const int width = map.layout.width();
  const int height = map.layout.height();
  snapshot.model.maps = map.layout;
  snapshot.normalMap = std::make_shared<const HullMap>(
      HullMap{map.layout, encodePng(width, height, 2, map.normals)});
  snapshot.colorMap =
      std::make_shared<const HullMap>(HullMap{map.layout, encodePng(width, height, 3, map.colors)});
  renderer_ = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer_);
  const Camera camera = orbitCamera(snapshot.model.sphere, 40.0, 20.0, 2.5, 40.0);
  RenderOptions options;
  options.viewport = {kSize, kSize};
  options.paper = glm::vec3(0.0F);
  options.draw = DrawMode::kShaded;
  const auto truth = renderer_->render(snapshot, {}, camera, options);
  options.draw = DrawMode::kClip;
  const auto clip = renderer_->render(
      snapshot,
      silhouetteOf(snapshot, camera, SilhouetteKind::kEdges),
      camera,
      options);
  ASSERT_TRUE(truth && clip);
  // What is left is where the polygonal inside of the hull's outline hides something else, and
  // flat faces lit one by one against interpolated normals.
  std::vector<int> differences;
  int painted = 0;
  for (std::size_t i = 0; i < truth->image.rgba.size(); i += 4) {
    int most = 0;
    for (std::size_t k = i; k < i + 3; ++k)
      most = std::max(most, std::abs(truth->image.rgba[k] - clip->image.rgba[k]));
    if (truth->image.rgba[i + 1] + truth->image.rgba[i] > 30) differences.push_back(most);
    painted += truth->image.rgba[i] > truth->image.rgba[i + 1] + 30 ? 1 : 0;
  }
  ASSERT_GT(differences.size(), 5000U);
  EXPECT_GT(painted, 500);  // it is not grey
  std::ranges::sort(differences);
  const int median = differences[differences.size() / 2];
  const int tail = differences[differences.size() * 9 / 10];
  std::printf("paint: median %d levels off, 90 %% within %d\n", median, tail);
  EXPECT_LT(median, 8);
  EXPECT_LT(tail, 30);
}

/// A mesh with its hull, painted all over in red, green or blue.
MeshSnapshot painted(const TriangleMesh& mesh, std::size_t channel) {
  MeshSnapshot snapshot = withHull(mesh);
  const auto level = hullAfter(*snapshot.outerHull, snapshot.outerHull->splitsFor(kHullFaces));
  EXPECT_TRUE(level);
  const MapLayout layout{static_cast<std::uint32_t>(level->triangles.size()), 4};
  std::vector<std::uint8_t> texels(
      3 * static_cast<std::size_t>(layout.width()) * static_cast<std::size_t>(layout.height()),
      0);
  for (std::size_t i = channel; i < texels.size(); i += 3)
    texels[i] = kMapColorSteps;
  snapshot.model.maps = layout;
  snapshot.model.asset[0] = static_cast<std::uint8_t>(channel + 1);
  snapshot.colorMap = std::make_shared<const HullMap>(
      HullMap{layout, encodePng(layout.width(), layout.height(), 3, texels)});
  return snapshot;
}

/// Draws the objects, whose paint is red, green and blue, together, and compares each pixel with
/// which full mesh is nearest there.
void checkScene(
    Renderer& renderer,
    const std::vector<const MeshSnapshot*>& snapshots,
    const std::vector<glm::dvec3>& places,
    int views) {
  int wrong = 0;
  int pale = 0;
  int inner = 0;
  int seams = 0;
  for (int view = 0; view < views; ++view) {
    std::vector<BoundingSphere> spheres;
    for (std::size_t i = 0; i < snapshots.size(); ++i)
      spheres.push_back(
          {snapshots[i]->model.sphere.center + places[i], snapshots[i]->model.sphere.radius});
    const BoundingSphere around = sphereAround(spheres);
    const Camera camera =
        orbitCamera(around, 360.0 * view / views + 5.0, -75.0 + 50.0 * (view % 4), 2.5, 40.0);
    RenderOptions options;
    options.viewport = {kSize, kSize};
    options.paper = glm::vec3(1.0F);
    options.hullFaces = kHullFaces;
    std::vector<PolylineSet> lines;
    std::vector<DepthImage> depths;
    for (std::size_t i = 0; i < snapshots.size(); ++i) {
      const Camera own = seenFrom(camera, places[i]);
      lines.push_back(silhouetteOf(*snapshots[i], own, SilhouetteKind::kEdges));
      options.draw = DrawMode::kShaded;
      options.supersample = 1;
      options.keepDepth = true;
      auto frame = renderer.render(*snapshots[i], {}, own, options);
      ASSERT_TRUE(frame);
      depths.push_back(std::move(frame->depth));
    }
    std::vector<SceneObject> objects;
    for (std::size_t i = 0; i < snapshots.size(); ++i)
      objects.push_back({*snapshots[i], lines[i], places[i]});
    options.draw = DrawMode::kClip;
    options.keepDepth = false;
    const auto scene = renderer.renderScene(objects, camera, options);
    ASSERT_TRUE(scene) << scene.error().message;
    constexpr int kPaper = 3;
    const auto nearest = [&](int x, int y) {
      int best = kPaper;
      float least = 1.0F;
      for (std::size_t i = 0; i < depths.size(); ++i) {
        const float depth = depths[i].depth[static_cast<std::size_t>(y * kSize + x)];
        if (depth >= least) continue;
        least = depth;
        best = static_cast<int>(i);
      }
      return best;
    };
    for (int y = 1; y + 1 < kSize; ++y) {
      for (int x = 1; x + 1 < kSize; ++x) {
        const int truth = nearest(x, y);
        const auto isWithin = [&](int reach, auto&& holds) {
          for (int v = std::max(0, y - reach); v <= std::min(kSize - 1, y + reach); ++v) {
            for (int u = std::max(0, x - reach); u <= std::min(kSize - 1, x + reach); ++u) {
              if (holds(nearest(u, v))) return true;
            }
          }
          return false;
        };
        const bool isEdge = isWithin(1, [&](int here) { return here != truth; });
        const std::uint8_t* rgb = &scene->image.rgba[4 * static_cast<std::size_t>(y * kSize + x)];
        if (!isEdge) {
          ++inner;
          const bool isPaper = rgb[0] > 200 && rgb[1] > 200 && rgb[2] > 200;
          const int seen =
              isPaper ? kPaper : static_cast<int>(std::max_element(rgb, rgb + 3) - rgb);
          wrong += seen == truth ? 0 : 1;
        } else if (snapshots.size() == 2 && !isWithin(4, [](int here) { return here == kPaper; })) {
          // Red meets green: no paper, which has blue, shows between them, but where it ends in a
          // wedge that is narrower than a pixel.
          ++seams;
          pale += rgb[2] > 8 ? 1 : 0;
        }
      }
    }
  }
  std::printf("scene: %d of %d wrong, %d of %d pale at seams\n", wrong, inner, pale, seams);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(pale, 0);
  if (snapshots.size() == 2) {
    EXPECT_GT(seams, 100);
  }
}

TEST_F(ClipOutline, OfSeveralModelsTheNearestShowsAndTheNextBehindItsEdges) {
  renderer_ = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer_);
  const MeshSnapshot red = painted(primitives::torus(60, 30), 0);
  const MeshSnapshot green = painted(primitives::bumpySphere(4, 3), 1);
  const MeshSnapshot blue = painted(primitives::torus(40, 20), 2);
  const auto beside = [&red](const MeshSnapshot& other, const glm::dvec3& direction) {
    const double away = 1.02 * (red.model.sphere.radius + other.model.sphere.radius);
    return red.model.sphere.center + away * direction - other.model.sphere.center;
  };
  checkScene(
      *renderer_,
      {&red, &green},
      {glm::dvec3(0.0), beside(green, glm::dvec3(1.0, 0.0, 0.0))},
      12);
  checkScene(
      *renderer_,
      {&red, &green, &blue},
      {glm::dvec3(0.0),
       beside(green, glm::dvec3(1.0, 0.0, 0.0)),
       beside(blue, glm::dvec3(0.0, 0.6, -0.8))},
      8);
}

TEST(SceneOrder, IsFarToNearForSpheresThatDoNotMeet) {
  Rng rng(3);
  for (int round = 0; round < 500; ++round) {
    std::vector<BoundingSphere> spheres;
    while (spheres.size() < 4) {
      const BoundingSphere next{
          10.0 * glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()),
          0.2 + 4.0 * rng.uniform()};
      const bool meets = std::ranges::any_of(spheres, [&](const BoundingSphere& other) {
        return glm::distance(next.center, other.center) < next.radius + other.radius;
      });
      if (!meets) spheres.push_back(next);
    }
    Camera camera;
    camera.eye = 40.0 * glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()) - 15.0;
    camera.target = glm::dvec3(5.0);
    camera.orthographic = round % 2 == 1;
    const auto order = farToNear(spheres, camera);
    // Along any line of sight through two of them the later one in the order is met first.
    for (int line = 0; line < 300; ++line) {
      glm::dvec3 from = camera.eye;
      glm::dvec3 along = 10.0 * glm::dvec3(rng.uniform(), rng.uniform(), rng.uniform()) - from;
      if (camera.orthographic) {
        from = from + along;
        along = camera.forward();
      }
      along = glm::normalize(along);
      double last = 1e300;
      for (const std::size_t i : order) {
        const glm::dvec3 to = spheres[i].center - from;
        const double middle = glm::dot(to, along);
        const double half =
            spheres[i].radius * spheres[i].radius - (glm::dot(to, to) - middle * middle);
        if (half <= 0.0 || (!camera.orthographic && middle <= 0.0)) continue;
        if (glm::length(to) < spheres[i].radius) continue;  // the eye is inside
        ASSERT_LT(middle - std::sqrt(half), last);
        last = middle - std::sqrt(half);
      }
    }
  }
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
