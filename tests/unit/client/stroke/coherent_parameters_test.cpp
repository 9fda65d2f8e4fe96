// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/coherent_parameters.h"

#include "client/stroke/chain/chain.h"
#include "client/stroke/stroke_builder.h"
#include "tests/texture_slide.h"

#include "shared/mesh/primitives.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

namespace limn {
namespace {

constexpr Viewport kViewport{512, 512};

/// Frames of a model's smooth silhouettes, as strokes.
class Film {
 public:
  explicit Film(const TriangleMesh& shape)
      : shape_(shape),
        mesh_(*HalfEdgeMesh::build(
            static_cast<std::uint32_t>(shape.positions.size()),
            shape.triangles)),
        field_(mesh_, shape_.positions, SilhouetteKind::kSmooth),
        detector_(makeDetector(DetectorMethod::kBrute, field_)) {
    style_.widthPx = 3.0F;
    style_.visible.lengthPx = 256.0F;
    style_.hidden.lengthPx = 128.0F;
  }

  using Frame = StrokeFrame;

  Frame shoot(double azimuth, StrokeBuilder& builder, double distance = 3.0) {
    const BoundingSphere sphere = boundingSphere(shape_.grid, shape_.positions);
    const Camera camera = orbitCamera(sphere, azimuth, 20.0, distance);
    const LineScene scene{mesh_, shape_.positions, shape_.grid, camera, kViewport};
    const SilhouetteView view{shape_.grid.fromModel(camera.eye), camera.forward(), false};
    const PolylineSet& lines = chainer_.chain(field_, view, detector_->detect(view));
    const BuiltStrokes built = builder.build(lines, scene, style_, {.widthPx = style_.widthPx});
    return {camera, built.spines, built.parameters};
  }

  void setTextureLength(float lengthPx) {
    style_.visible.lengthPx = lengthPx;
    style_.hidden.lengthPx = lengthPx / 2.0F;
  }

  [[nodiscard]] float period() const { return texturePeriod(style_, style_.widthPx); }

  [[nodiscard]] std::vector<float> slides(const Frame& before, const Frame& after) const {
    return textureSlides(before, after, kViewport, period());
  }

 private:
  TriangleMesh shape_;
  HalfEdgeMesh mesh_;
  SilhouetteField field_;
  std::unique_ptr<SilhouetteDetector> detector_;
  SilhouetteChainer chainer_;
  StrokeStyle style_;
};

float medianOf(std::vector<float> values) {
  if (values.empty()) return 0.0F;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

float shareAbove(const std::vector<float>& values, float limit) {
  const auto above =
      std::count_if(values.begin(), values.end(), [&](float v) { return v > limit; });
  return static_cast<float>(above) / static_cast<float>(std::max<std::size_t>(values.size(), 1));
}

struct Slides {
  std::vector<float> followed;
  std::vector<float> fresh;  // each frame for itself: the control
};

Slides orbit(const TriangleMesh& shape, int frames) {
  Film film(shape);
  StrokeBuilder builder;
  Slides slides;
  Film::Frame last = film.shoot(10.0, builder);
  Film::Frame lastFresh = last;
  for (int i = 1; i <= frames; ++i) {
    const Film::Frame frame = film.shoot(10.0 + i, builder);
    StrokeBuilder forgetful;
    const Film::Frame fresh = film.shoot(10.0 + i, forgetful);
    const std::vector<float> followed = film.slides(last, frame);
    slides.followed.insert(slides.followed.end(), followed.begin(), followed.end());
    const std::vector<float> alone = film.slides(lastFresh, fresh);
    slides.fresh.insert(slides.fresh.end(), alone.begin(), alone.end());
    last = frame;
    lastFresh = fresh;
  }
  return slides;
}

void expectStill(const char* name, const TriangleMesh& shape) {
  const Slides slides = orbit(shape, 20);
  ASSERT_GT(slides.followed.size(), 500U);
  std::printf(
      "%s: slide a frame at 1 degree: median %.3f px (%.1f %% above 3 px); each frame alone: %.1f "
      "px\n",
      name,
      medianOf(slides.followed),
      100.0F * shareAbove(slides.followed, 3.0F),
      medianOf(slides.fresh));
  EXPECT_LE(medianOf(slides.followed), 1.0F);
  EXPECT_LT(shareAbove(slides.followed, 3.0F), 0.1F);
  EXPECT_GT(medianOf(slides.fresh), 10.0F);  // or the test would show nothing
}

TEST(CoherentParameters, OrbitingByADegreeAFrameSlidesByLessThanAPixel) {
  expectStill("bumpy sphere", primitives::bumpySphere(4, 3));
  expectStill("knot", primitives::torusKnot(2, 3, 200, 24));
}

TEST(CoherentParameters, AStillCameraKeepsEveryParameterToTheLastBit) {
  Film film(primitives::torusKnot(2, 3, 120, 16));
  StrokeBuilder builder;
  static_cast<void>(film.shoot(30.0, builder));
  const Film::Frame first = film.shoot(31.0, builder);
  for (int i = 0; i < 3; ++i) {
    const Film::Frame again = film.shoot(31.0, builder);
    EXPECT_EQ(again.parameters.from, first.parameters.from);
    EXPECT_EQ(again.parameters.to, first.parameters.to);
  }
}

TEST(CoherentParameters, AnotherTextureSizeFitsLoopsAnewWhereTheCameraIsStill) {
  Film film(primitives::bumpySphere(4, 3));
  StrokeBuilder builder;
  static_cast<void>(film.shoot(30.0, builder));
  film.setTextureLength(61.0F);
  const Film::Frame frame = film.shoot(30.0, builder);
  int loops = 0;
  for (const SpineSet::Spine& spine : frame.spines.spines) {
    if (!spine.closed) continue;
    const float around = frame.parameters.to[spine.end - 1] - frame.parameters.from[spine.begin];
    const float repeats = around / film.period();
    EXPECT_NEAR(repeats, std::round(repeats), 1e-3F);
    ++loops;
  }
  EXPECT_GT(loops, 0);
}

TEST(CoherentParameters, ATextureIsNotSqueezedIntoASmallLoop) {
  Film film(primitives::bumpySphere(4, 3));
  film.setTextureLength(3000.0F);
  StrokeBuilder builder;
  const Film::Frame frame = film.shoot(30.0, builder);
  int small = 0;
  for (const SpineSet::Spine& spine : frame.spines.spines) {
    float length = 0.0F;
    for (std::uint32_t i = spine.begin; i < spine.end; ++i) {
      const std::uint32_t next = i + 1 < spine.end ? i + 1 : spine.begin;
      length += glm::distance(frame.spines.points[i], frame.spines.points[next]);
    }
    if (!spine.closed || length > 0.5F * film.period()) continue;
    const float around = frame.parameters.to[spine.end - 1] - frame.parameters.from[spine.begin];
    EXPECT_NEAR(around / length, 1.0F, 1e-3F);
    ++small;
  }
  EXPECT_GT(small, 0);
}

TEST(CoherentParameters, ComingBackAfterAFewFramesFindsTheParametersNearWhereTheyWere) {
  Film film(primitives::bumpySphere(4, 3));
  StrokeBuilder builder;
  const Film::Frame first = film.shoot(30.0, builder);
  Film::Frame last;
  for (const double azimuth : {31.0, 32.0, 33.0, 32.0, 31.0, 30.0})
    last = film.shoot(azimuth, builder);
  EXPECT_LT(medianOf(film.slides(first, last)), 2.0F);
}

TEST(CoherentParameters, ZoomingStretchesTexturesOnlySoFar) {
  Film film(primitives::bumpySphere(4, 3));
  StrokeBuilder builder;
  Film::Frame frame;
  for (int i = 0; i <= 120; ++i)
    frame = film.shoot(30.0, builder, 12.0 * std::pow(0.985, i));
  // Sixfold by now.
  double parameter = 0.0;
  double arc = 0.0;
  for (const SpineSet::Spine& spine : frame.spines.spines) {
    for (std::uint32_t i = spine.begin; i + 1 < spine.end; ++i) {
      parameter += frame.parameters.to[i] - frame.parameters.from[i];
      arc += glm::distance(frame.spines.points[i], frame.spines.points[i + 1]);
    }
  }
  EXPECT_GT(parameter / arc, 0.5);
  EXPECT_LT(parameter / arc, 1.6);
}

}  // namespace
}  // namespace limn
