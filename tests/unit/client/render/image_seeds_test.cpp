// SPDX-License-Identifier: Apache-2.0
#include "client/render/image_seeds.h"

#include "tests/unit/client/render/scene_fixture.h"

#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#if LIMN_TEST_OPENCV
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#endif

#include <algorithm>
#include <vector>

namespace limn {
namespace {

Camera cameraFor(const MeshSnapshot& snapshot, double azimuth) {
  Camera camera = orbitCamera(snapshot.model.sphere, azimuth, 20.0);
  fitDepthRange(snapshot.model.sphere, camera);
  return camera;
}

class ImageSeedsOf : public ::testing::TestWithParam<GlBackend> {
 protected:
  static ImageSeeds make(const ImageSeeds::Options& options) {
    auto seeds = ImageSeeds::create(GetParam(), options);
    EXPECT_TRUE(seeds) << seeds.error().message;
    return *std::move(seeds);
  }
};

#if LIMN_TEST_OPENCV
// Counts edge pixels of one picture that the other lacks, either way.
struct Disagreement {
  int edges = 0;
  int pixels = 0;
};

Disagreement compareWithOpenCv(ImageSeeds& seeds, const ImageSeeds::Options& options) {
  std::vector<std::uint8_t> normals = seeds.normalImage();
  const std::vector<std::uint8_t> ours = seeds.edgeImage();
  const cv::Mat rgba(options.viewport.height, options.viewport.width, CV_8UC4, normals.data());
  cv::Mat rgb;
  cv::cvtColor(rgba, rgb, cv::COLOR_RGBA2RGB);
  cv::Mat theirs;
  cv::Canny(rgb, theirs, options.lowThreshold, options.highThreshold);
  Disagreement result;
  for (int i = 0; i < static_cast<int>(ours.size()); ++i) {
    const bool isTheirs = theirs.data[i] != 0;
    result.edges += isTheirs ? 1 : 0;
    result.pixels += isTheirs != (ours[static_cast<std::size_t>(i)] != 0) ? 1 : 0;
  }
  return result;
}

TEST_P(ImageSeedsOf, EdgesAreThoseOfOpenCvsCanny) {
  ImageSeeds::Options options;
  options.viewport = {160, 120};
  options.hysteresisSteps = 100;  // as far as any weak edge goes in so small a picture
  ImageSeeds seeds = make(options);
  for (const TriangleMesh& shape :
       {primitives::bumpySphere(4, 7), primitives::torusKnot(2, 3, 200, 24), primitives::cube()}) {
    const MeshSnapshot snapshot = snapshotOf(shape);
    (void)seeds.find(snapshot, cameraFor(snapshot, 75.0));
    const Disagreement d = compareWithOpenCv(seeds, options);
    EXPECT_GT(d.edges, 50);
    EXPECT_EQ(d.pixels, 0) << "of " << d.edges;
  }
}

TEST_P(ImageSeedsOf, AFewStepsOfHysteresisLoseLittle) {
  ImageSeeds::Options options;
  options.viewport = {320, 240};
  ImageSeeds seeds = make(options);
  const MeshSnapshot snapshot = snapshotOf(primitives::bumpySphere(4, 7));
  (void)seeds.find(snapshot, cameraFor(snapshot, 10.0));
  const Disagreement d = compareWithOpenCv(seeds, options);
  EXPECT_LE(d.pixels, d.edges / 20);
}
#endif

TEST_P(ImageSeedsOf, LeadTheDetectorToTheVisibleSilhouettes) {
  ImageSeeds::Options options;
  options.viewport = {256, 256};
  options.hysteresisSteps = 8;
  ImageSeeds seeds = make(options);
  const MeshSnapshot snapshot = snapshotOf(primitives::torus(96, 48));
  const Camera camera = cameraFor(snapshot, 30.0);
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    const SilhouetteField field(snapshot.mesh.mesh(), snapshot.mesh.positions(), kind);
    DetectorOptions detector;
    detector.imageFaces = [&](const SilhouetteView&) { return seeds.find(snapshot, camera); };
    const SilhouetteView view{snapshot.model.grid.fromModel(camera.eye), camera.forward(), false};
    const auto image = makeDetector(DetectorMethod::kImage, field, detector);
    const auto brute = makeDetector(DetectorMethod::kBrute, field);
    // Both contours of a torus are seen in part.
    EXPECT_GT(recall(image->detect(view), brute->detect(view)), 0.9);
    EXPECT_LT(image->detect(view).stats.facesVisited, field.mesh().faceCount());
  }
}

TEST_P(ImageSeedsOf, NothingInThePictureGivesNothing) {
  ImageSeeds seeds = make({.viewport = {64, 64}});
  const MeshSnapshot snapshot = snapshotOf(primitives::cube());
  Camera away = cameraFor(snapshot, 30.0);
  away.target = away.eye + (away.eye - away.target);
  EXPECT_TRUE(seeds.find(snapshot, away).empty());
  EXPECT_FALSE(seeds.find(snapshot, cameraFor(snapshot, 30.0)).empty());
}

INSTANTIATE_TEST_SUITE_P(
    Backends,
    ImageSeedsOf,
    ::testing::Values(GlBackend::kEgl, GlBackend::kOsmesa),
    [](const auto& backend) { return backend.param == GlBackend::kEgl ? "Egl" : "Osmesa"; });

}  // namespace
}  // namespace limn
