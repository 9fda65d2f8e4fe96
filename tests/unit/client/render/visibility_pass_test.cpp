// SPDX-License-Identifier: Apache-2.0
#include "client/render/mesh_pass.h"
#include "client/render/stroke_pass.h"
#include "client/stroke/visibility.h"
#include "tests/unit/client/render/scene_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

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
  const SpineSet spines = projectLines(lines, scene);
  const SpineSamples samples =
      sampleSpines(spines, measureSpines(spines), lines, findSpans(lines, scene), scene);
  ASSERT_GT(samples.samples.size(), 1024U);  // more than a row of the atlas
  ASSERT_TRUE(strokePass->findVisibility(samples, depth->depth()));
  const std::vector<float> drawn = strokePass->readVisibility(samples.samples.size());
  const std::vector<float> expected = sampleVisibility(samples, frame->depth);
  std::size_t different = 0;
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    different += std::abs(drawn[i] - expected[i]) > 1.0F / 128.0F ? 1 : 0;
    hidden += expected[i] < 0.5F ? 1 : 0;
  }
  // A position within rounding of a pixel's edge may fall to either side, which changes as many
  // samples as the filter's window has.
  EXPECT_LE(different, expected.size() / 100);
  // The picture has enough of both for the comparison to mean something.
  EXPECT_GT(hidden, expected.size() / 10);
  EXPECT_LT(hidden, expected.size() * 9 / 10);
}

TEST(VisibilityPass, AgreesWithTheCpuOnEgl) {
  expectAgreement(GlBackend::kEgl, SilhouetteKind::kSmooth);
}

TEST(VisibilityPass, AgreesWithTheCpuOnOsmesa) {
  expectAgreement(GlBackend::kOsmesa, SilhouetteKind::kEdges);
}

}  // namespace
}  // namespace limn
