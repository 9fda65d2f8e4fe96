// SPDX-License-Identifier: Apache-2.0
#include "client/render/mesh_pass.h"
#include "client/render/stroke_pass.h"
#include "client/stroke/drawn_spines.h"
#include "client/stroke/line_density.h"
#include "client/stroke/line_halo.h"
#include "client/stroke/nested_contours.h"
#include "client/stroke/visibility/visibility.h"
#include "tests/unit/client/render/scene_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace limn {
namespace {

/// The shaders' visibility of every sample against the CPU's, on the depth that GL drew.
void expectAgreement(GlBackend backend, SilhouetteKind kind) {
  auto renderer = makeRenderer(backend);  // for the depth image
  ASSERT_TRUE(renderer);
  const MeshSnapshot knot = snapshotOf(primitives::torusKnot(2, 3, 200, 24));
  const Camera camera = orbitCamera(knot.model.sphere, 33, 21, 2.2);
  const PolylineSet lines = silhouetteOf(knot, camera, kind);
  RenderOptions options;
  options.viewport = {200, 200};
  options.keepDepth = true;
  const auto frame = renderer->render(knot, lines, camera, options);
  ASSERT_TRUE(frame) << frame.error().message;

  auto context = createGlContext(backend);
  ASSERT_TRUE(context);
  const gl::Api& api = (*context)->api();
  auto meshPass = MeshPass::create(api);
  auto strokePass = StrokePass::create(api);
  ASSERT_TRUE(meshPass && strokePass);
  (void)meshPass->upload(knot);
  const auto depth = gl::Target::create(
      api,
      "depth",
      {.size = {frame->depth.width, frame->depth.height}, .hasColor = false, .hasDepth = true});
  ASSERT_TRUE(depth);
  meshPass->drawDepth(knot, camera, *depth);

  const LineScene scene{
      knot.mesh.mesh(),
      knot.mesh.positions(),
      knot.model.grid,
      camera,
      options.viewport};
  DrawnSpines strokes;
  strokes.find(lines, scene, StrokeStyle{}, 3.0F);
  const SpineSet& spines = strokes.spines;
  SpineSamples samples =
      sampleSpines(spines, measureSpines(spines), findSpans(lines, scene), scene.viewport);
  NestedContours().find(scene.viewport, 3.0F, strokes.fades, samples);
  ASSERT_GT(samples.samples.size(), 1024U);  // more than a row of the atlas
  ASSERT_TRUE(strokePass->findVisibility(samples, depth->depth(), closedGap(3.0F)));
  const std::vector<float> drawn = strokePass->readVisibility(samples.samples.size());
  const std::vector<float> expected = sampleVisibility(samples, frame->depth, closedGap(3.0F));
  std::size_t different = 0;
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    different += std::abs(drawn[i] - expected[i]) > 1.0F / 128.0F ? 1 : 0;
    hidden += expected[i] < 0.5F ? 1 : 0;
  }
  ASSERT_TRUE(strokePass->findHalo(samples, {.viewport = options.viewport, .widthPx = 3.0F}));
  const std::vector<float> clear = strokePass->readClear(samples.samples.size());
  LineHalo halo(options.viewport, 3.0F);
  const auto pixelOf = [&](std::size_t i) {
    return samples.samples[i].position * glm::vec2(options.viewport.width, options.viewport.height);
  };
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (drawn[i] > 0.5F) halo.add(pixelOf(i));
  }
  std::size_t inHalo = 0;
  std::size_t otherwise = 0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const bool isClear = drawn[i] > 0.5F || !halo.isNear(pixelOf(i));
    inHalo += isClear ? 0 : 1;
    otherwise += isClear == (clear[i] > 0.5F) ? 0 : 1;
  }
  EXPECT_LE(otherwise, expected.size() / 100);
  EXPECT_GT(inHalo, 20U);
  EXPECT_LT(inHalo, hidden);
  // A position within rounding of a pixel's edge may fall to either side, which changes as many
  // samples as the filter's window has.
  EXPECT_LE(different, expected.size() / 100);
  // The picture has enough of both for the comparison to mean something.
  EXPECT_GT(hidden, expected.size() / 10);
  EXPECT_LT(hidden, expected.size() * 9 / 10);
}

/// Nothing in front of anything: what is not hidden for sure is visible.
gl::Target emptyDepth(const gl::Api& api) {
  auto depth =
      gl::Target::create(api, "depth", {.size = {64, 64}, .hasColor = false, .hasDepth = true});
  EXPECT_TRUE(depth);
  depth->bind();
  api.clear(GL_DEPTH_BUFFER_BIT);
  return *std::move(depth);
}

TEST(VisibilityPass, ABridgeIsVisibleWhereWhatItJoinsIs) {
  auto context = createGlContext(GlBackend::kEgl);
  ASSERT_TRUE(context);
  const gl::Api& api = (*context)->api();
  auto strokePass = StrokePass::create(api);
  ASSERT_TRUE(strokePass);
  const gl::Target depth = emptyDepth(api);
  // A visible line, a hidden one, and bridges between either and themselves.
  constexpr int kCount = 10;
  SpineSamples samples;
  const auto add = [&](float bias, float neededFree, float joinedFrom, float joinedTo) {
    const auto first = static_cast<float>(samples.samples.size());
    for (int i = 0; i < kCount; ++i) {
      SpineSample sample;
      sample.position = glm::vec2(0.5F);
      sample.depth = 0.5F;
      sample.bias = bias;
      sample.first = first;
      sample.last = first + kCount - 1;
      sample.neededFree = neededFree;
      sample.spanFirst = neededFree == kAsJoined ? joinedFrom : first;
      sample.spanLast = neededFree == kAsJoined ? joinedTo : sample.last;
      samples.samples.push_back(sample);
    }
  };
  add(0.01F, kFreeNeighbours, 0.0F, 0.0F);
  add(-1.0F, kFreeNeighbours, 0.0F, 0.0F);
  add(0.0F, kAsJoined, 5.0F, 5.0F);
  add(0.0F, kAsJoined, 5.0F, 15.0F);
  add(0.0F, kAsJoined, 15.0F, 5.0F);
  // Nested in the first, and a bridge from there.
  add(0.01F, kFreeNeighbours, 0.0F, 0.0F);
  for (std::size_t i = 50; i < 60; ++i)
    samples.samples[i].nestedIn = 5.0F;
  add(0.0F, kAsJoined, 55.0F, 5.0F);
  ASSERT_TRUE(strokePass->findVisibility(samples, depth.depth()));
  const std::vector<float> drawn = strokePass->readVisibility(samples.samples.size());
  DepthImage empty{64, 64, {}};
  empty.depth.assign(64 * 64, 1.0F);
  EXPECT_EQ(drawn, sampleVisibility(samples, empty));
  for (std::size_t i = 0; i < drawn.size(); ++i)
    EXPECT_EQ(drawn[i], i < kCount || (i >= 2 * kCount && i < 3 * kCount) ? 1.0F : 0.0F) << i;
}

TEST(VisibilityPass, ANestedContourIsDrawnWhereTheOuterOneIsNotVisible) {
  auto context = createGlContext(GlBackend::kEgl);
  ASSERT_TRUE(context);
  const gl::Api& api = (*context)->api();
  auto strokePass = StrokePass::create(api);
  ASSERT_TRUE(strokePass);
  const gl::Target depth = emptyDepth(api);
  // Two lines of a hundred samples, the first's second half hidden, the other nested in it.
  SpineSamples samples;
  for (int i = 0; i < 200; ++i) {
    SpineSample sample;
    sample.position = glm::vec2(0.5F);
    sample.depth = 0.5F;
    sample.bias = i >= 50 && i < 100 ? -1.0F : 0.01F;
    sample.first = i < 100 ? 0.0F : 100.0F;
    sample.last = sample.first + 99.0F;
    sample.spanFirst = i < 50 ? 0.0F : (i < 100 ? 50.0F : 100.0F);
    sample.spanLast = i < 50 ? 49.0F : (i < 100 ? 99.0F : 199.0F);
    if (i >= 100) sample.nestedIn = static_cast<float>(i - 100);
    samples.samples.push_back(sample);
  }
  ASSERT_TRUE(strokePass->findVisibility(samples, depth.depth()));
  const std::vector<float> drawn = strokePass->readVisibility(samples.samples.size());
  DepthImage empty{64, 64, {}};
  empty.depth.assign(64 * 64, 1.0F);
  const std::vector<float> expected = sampleVisibility(samples, empty);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    EXPECT_NEAR(drawn[i], expected[i], 1.0F / 128.0F) << i;
    EXPECT_EQ(drawn[i] > 0.5F, i < 50 || i >= 150) << i;
  }
}

TEST(VisibilityPass, ALoopIsTheSameWhereverItBegins) {
  auto context = createGlContext(GlBackend::kEgl);
  ASSERT_TRUE(context);
  const gl::Api& api = (*context)->api();
  auto strokePass = StrokePass::create(api);
  ASSERT_TRUE(strokePass);
  const gl::Target depth = emptyDepth(api);
  constexpr int kCount = 40;
  constexpr int kHidden = 13;
  SpineSamples samples;
  // Loops of which the same part is hidden, each begun a sample farther on, and a copy of the
  // first.
  for (int turn = 0; turn < kCount; ++turn) {
    const auto first = static_cast<float>(samples.samples.size());
    for (int i = 0; i <= kCount; ++i) {
      SpineSample sample;
      sample.position = glm::vec2(0.5F);
      sample.depth = 0.5F;
      sample.bias = (i + turn) % kCount < kHidden ? -1.0F : 0.01F;
      sample.first = first;
      sample.last = -(first + kCount - 1);
      sample.spanFirst = sample.spanLast = first + static_cast<float>(i);
      samples.samples.push_back(sample);
    }
  }
  ASSERT_TRUE(strokePass->findVisibility(samples, depth.depth()));
  const std::vector<float> drawn = strokePass->readVisibility(samples.samples.size());
  for (int turn = 0; turn < kCount; ++turn) {
    for (int i = 0; i <= kCount; ++i) {
      const auto at = static_cast<std::size_t>(turn * (kCount + 1) + i);
      EXPECT_EQ(drawn[at], drawn[static_cast<std::size_t>((i + turn) % kCount)])
          << "begun at " << turn << ", sample " << i;
    }
  }
}

TEST(VisibilityPass, CountsTheLinesInEachCell) {
  auto context = createGlContext(GlBackend::kEgl);
  ASSERT_TRUE(context);
  const gl::Api& api = (*context)->api();
  auto strokePass = StrokePass::create(api);
  ASSERT_TRUE(strokePass);
  const gl::Target depth = emptyDepth(api);
  const Viewport viewport{100, 70};
  LineDensity density(viewport);
  SpineSamples samples;
  for (int i = 0; i < 700; ++i) {
    const bool isVisible = i < 500;
    const glm::vec2 pixel(0.5F + static_cast<float>(i % 140), isVisible ? 20.5F : 45.5F);
    SpineSample sample;
    sample.position = pixel / glm::vec2(viewport.width, viewport.height);
    sample.depth = 0.5F;
    sample.bias = isVisible ? 0.01F : -1.0F;
    sample.first = sample.spanFirst = isVisible ? 0.0F : 500.0F;
    sample.last = sample.spanLast = isVisible ? 499.0F : 699.0F;
    samples.samples.push_back(sample);
    density.add(pixel, isVisible);
  }
  ASSERT_TRUE(strokePass->findVisibility(samples, depth.depth()));
  ASSERT_TRUE(strokePass->findDensity(samples, {.viewport = viewport}));
  const std::vector<glm::ivec2> counts = strokePass->readDensity();
  const int columns = densityCells(viewport.width);
  ASSERT_EQ(counts.size(), static_cast<std::size_t>(columns * densityCells(viewport.height)));
  for (int y = 0; y < densityCells(viewport.height); ++y) {
    for (int x = 0; x < columns; ++x) {
      const glm::ivec2 count = counts[static_cast<std::size_t>(y * columns + x)];
      const glm::vec2 expected = density.countAt({x, y});
      EXPECT_EQ(count.x, static_cast<int>(expected.x)) << x << ", " << y;
      EXPECT_EQ(count.y, static_cast<int>(expected.y)) << x << ", " << y;
    }
  }
}

TEST(VisibilityPass, AgreesWithTheCpuOnEgl) {
  expectAgreement(GlBackend::kEgl, SilhouetteKind::kSmooth);
}

TEST(VisibilityPass, AgreesWithTheCpuOnOsmesa) {
  expectAgreement(GlBackend::kOsmesa, SilhouetteKind::kEdges);
}

}  // namespace
}  // namespace limn
