// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/client/render/scene_fixture.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace limn {
namespace {

constexpr DrawMode kModes[] = {
    DrawMode::kBackWireframe,
    DrawMode::kBackTranslate,
    DrawMode::kBackZScale,
    DrawMode::kBackOffset,
    DrawMode::kBackFatten,
    DrawMode::kBackCharcoal};
constexpr int kSize = 256;

/// A sphere's outline seen from D radii: its angle has sine 1/D. Pixels from the picture's centre.
double outlineRadius() {
  return 0.5 * kSize * std::tan(std::asin(1.0 / 3.0)) / std::tan(glm::radians(20.0));
}

/// Degrees in which no pixel within 2 px of the outline is inked.
int gaps(const Image& image) {
  int missing = 0;
  for (int step = 0; step < 360; ++step) {
    const double angle = step * std::numbers::pi / 180.0;
    int darkest = 0;
    for (double r = outlineRadius() - 2.0; r <= outlineRadius() + 2.0; r += 0.5) {
      const auto x = static_cast<int>(0.5 * kSize + r * std::cos(angle));
      const auto y = static_cast<int>(0.5 * kSize + r * std::sin(angle));
      darkest = std::max(darkest, darkness(image, x, y));
    }
    missing += darkest < 64 ? 1 : 0;
  }
  return missing;
}

/// Inked pixels nearer to the picture's centre than the outline by more than `margin`.
int strays(const Image& image, double margin) {
  int count = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double r = std::hypot(x + 0.5 - 0.5 * kSize, y + 0.5 - 0.5 * kSize);
      count += r < outlineRadius() - margin && darkness(image, x, y) >= 64 ? 1 : 0;
    }
  }
  return count;
}

/// Every face a mesh of its own, every other one or so turned over.
TriangleMesh unorientedSoup(const TriangleMesh& mesh) {
  TriangleMesh soup;
  soup.grid = mesh.grid;
  Rng rng(7);
  for (const glm::uvec3& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (int k = 0; k < 3; ++k)
      soup.positions.push_back(mesh.positions[t[k]]);
    glm::uvec3 face(first, first + 1, first + 2);
    if (rng.below(2) == 1) std::swap(face.y, face.z);
    soup.triangles.push_back(face);
  }
  return soup;
}

class BackFacesOn : public testing::TestWithParam<GlBackend> {};

TEST_P(BackFacesOn, EveryWayDrawsASpheresOutlineWithoutGapsOrStrays) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(5));
  const Camera camera = orbitCamera(sphere.model.sphere, 25, 35);
  for (const DrawMode mode : kModes) {
    const auto frame = renderer->render(sphere, {}, camera, blackOnWhite(kSize, mode));
    ASSERT_TRUE(frame) << nameOf(mode) << ": " << frame.error().message;
    EXPECT_EQ(gaps(frame->image), 0) << nameOf(mode);
    // Charcoal shades the front, darker towards the outline.
    const double margin = mode == DrawMode::kBackCharcoal ? 50.0 : 4.0;
    EXPECT_EQ(strays(frame->image, margin), 0) << nameOf(mode);
    EXPECT_EQ(darkness(frame->image, 1, 1), 0) << nameOf(mode);
  }
}

TEST_P(BackFacesOn, WindingsDoNotMatterWhereTheFirstLayerIsFoundByNumbers) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  MeshSnapshot soup = snapshotOf(unorientedSoup(primitives::icosphere(3)));
  soup.model.closed = false;
  const Camera camera = orbitCamera(soup.model.sphere, 25, 35);
  for (const DrawMode mode : kModes) {
    if (mode == DrawMode::kBackCharcoal) continue;  // its greys need normals
    const auto frame = renderer->render(soup, {}, camera, blackOnWhite(kSize, mode));
    ASSERT_TRUE(frame) << nameOf(mode) << ": " << frame.error().message;
    EXPECT_LE(gaps(frame->image), 3) << nameOf(mode);
    EXPECT_EQ(strays(frame->image, 6.0), 0) << nameOf(mode);
    // By winding, half of the front would be taken for back faces.
    RenderOptions byWinding = blackOnWhite(kSize, mode);
    byWinding.firstLayer = FirstLayer::kWinding;
    const auto wrong = renderer->render(soup, {}, camera, byWinding);
    ASSERT_TRUE(wrong);
    EXPECT_GT(strays(wrong->image, 6.0), 1000) << nameOf(mode);
  }
}

TEST_P(BackFacesOn, FattenedLinesAreAsWideAsAsked) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(5));
  const Camera camera = orbitCamera(sphere.model.sphere, 25, 35, 4.0);
  for (const double width : {2.0, 5.0, 9.0}) {
    RenderOptions options = blackOnWhite(kSize, DrawMode::kBackFatten);
    options.widthPx = width;
    const auto frame = renderer->render(sphere, {}, camera, options);
    ASSERT_TRUE(frame) << frame.error().message;
    double ink = 0.0;
    for (int x = 0; x < kSize / 2; ++x)
      ink += darkness(frame->image, x, kSize / 2) / 255.0;
    EXPECT_NEAR(ink, width, 0.8);
  }
}

TEST_P(BackFacesOn, LinesTakeTheirColourAndPaleWithDistance) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot torus = snapshotOf(primitives::torus(96, 48));
  // It stands upright; from below, its upper side is farther away.
  const Camera camera = orbitCamera(torus.model.sphere, 0, -40);
  RenderOptions options = blackOnWhite(kSize, DrawMode::kBackFatten);
  options.lineColor = glm::vec3(1.0F, 0.0F, 0.0F);
  options.lineFade = 1.0;
  const auto frame = renderer->render(torus, {}, camera, options);
  ASSERT_TRUE(frame) << frame.error().message;
  const auto darkestIn = [&](int from, int to) {
    int darkest = 0;
    for (int y = from; y < to; ++y)
      darkest = std::max(darkest, darkness(frame->image, kSize / 2, y));
    return darkest;
  };
  EXPECT_GT(darkestIn(kSize / 2, kSize), darkestIn(0, kSize / 4) + 50);
  for (std::size_t i = 0; i < frame->image.rgba.size(); i += 4) {
    ASSERT_EQ(frame->image.rgba[i], 255);  // red lines leave red as the paper has it
  }
}

TEST_P(BackFacesOn, AnOrthographicCameraSeesTheOutlineToo) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(4));
  Camera camera = orbitCamera(sphere.model.sphere, 25, 35);
  camera.orthographic = true;
  const double radius = 0.5 * kSize / (3.0 * std::tan(glm::radians(20.0)));
  for (const DrawMode mode : kModes) {
    const auto frame = renderer->render(sphere, {}, camera, blackOnWhite(kSize, mode));
    ASSERT_TRUE(frame) << nameOf(mode) << ": " << frame.error().message;
    int darkest = 0;
    for (double r = radius - 2.0; r <= radius + 2.0; r += 0.5) {
      darkest =
          std::max(darkest, darkness(frame->image, static_cast<int>(0.5 * kSize + r), kSize / 2));
    }
    EXPECT_GT(darkest, 100) << nameOf(mode);
  }
}

TEST_P(BackFacesOn, FromInsideAndOfNothingTheyDrawSomething) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(2));
  Camera inside = orbitCamera(sphere.model.sphere, 25, 35, 0.3);
  fitDepthRange(sphere.model.sphere, inside);
  MeshSnapshot nothing;
  nothing.revision = 9;
  for (const DrawMode mode : kModes) {
    EXPECT_TRUE(renderer->render(sphere, {}, inside, blackOnWhite(kSize, mode))) << nameOf(mode);
    EXPECT_TRUE(renderer->render(nothing, {}, inside, blackOnWhite(kSize, mode))) << nameOf(mode);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Backends,
    BackFacesOn,
    testing::Values(GlBackend::kEgl, GlBackend::kOsmesa),
    [](const auto& backend) { return backend.param == GlBackend::kEgl ? "Egl" : "Osmesa"; });

TEST(DrawOptions, NamesAreReadBackAndOthersRefused) {
  for (const DrawMode mode : kModes)
    EXPECT_EQ(parseDrawMode(nameOf(mode)).value(), mode);
  EXPECT_EQ(parseDrawMode("strokes").value(), DrawMode::kStrokes);
  EXPECT_TRUE(needsLines(DrawMode::kStrokes));
  EXPECT_FALSE(needsLines(DrawMode::kBackOffset));
  EXPECT_FALSE(parseDrawMode("image-precision"));
  EXPECT_EQ(parseFirstLayer("numbers").value(), FirstLayer::kNumbers);
  EXPECT_FALSE(parseFirstLayer("colours"));
}

}  // namespace
}  // namespace limn
