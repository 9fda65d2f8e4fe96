// SPDX-License-Identifier: Apache-2.0
// Lines that shaders find: from adjacency, and in the picture.
#include "client/render/edge_lines_method.h"
#include "tests/unit/client/render/scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

constexpr DrawMode kModes[] = {
    DrawMode::kGeometryShader,
    DrawMode::kConditionalLines,
    DrawMode::kImageEdges};
constexpr int kSize = 256;

/// Ink of a row of pixels, in pixels.
double inkOfRow(const Image& image, int y, int from, int to) {
  double ink = 0.0;
  for (int x = from; x < to; ++x)
    ink += darkness(image, x, y) / 255.0;
  return ink;
}

double totalInk(const Image& image) {
  double ink = 0.0;
  for (int y = 0; y < image.height; ++y)
    ink += inkOfRow(image, y, 0, image.width);
  return ink;
}

/// Whether there is ink within 2 px of a place in the mesh's grid.
bool isInkedNear(
    const Image& image,
    const MeshSnapshot& snapshot,
    const Camera& camera,
    const glm::dvec3& place) {
  const glm::dvec4 world(snapshot.model.grid.toModel(place), 1.0);
  const glm::dvec3 p = pixelFromClip(camera.clipFromWorld(1.0) * world, {kSize, kSize});
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      const int x = static_cast<int>(p.x) + dx;
      const int y = static_cast<int>(p.y) + dy;
      if (x < 0 || y < 0 || x >= kSize || y >= kSize) continue;
      if (darkness(image, x, y) > 64) return true;
    }
  }
  return false;
}

class ShaderLinesOn : public testing::TestWithParam<GlBackend> {};

TEST_P(ShaderLinesOn, ASpheresOutlineIsOneLineOfTheWidthAskedFor) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(5));
  const Camera camera = orbitCamera(sphere.model.sphere, 25, 35, 4.0);
  const double radius = 0.5 * kSize * std::tan(std::asin(1.0 / 4.0)) / std::tan(glm::radians(20.0));
  for (const DrawMode mode : kModes) {
    for (const double width : {2.0, 6.0}) {
      RenderOptions options = blackOnWhite(kSize, mode);
      options.widthPx = width;
      const auto frame = renderer->render(sphere, {}, camera, options);
      ASSERT_TRUE(frame) << nameOf(mode) << ": " << frame.error().message;
      const double length = 2.0 * std::numbers::pi * radius;
      EXPECT_NEAR(totalInk(frame->image) / length, width, 0.15 * width + 0.3) << nameOf(mode);
      EXPECT_NEAR(inkOfRow(frame->image, kSize / 2, 0, kSize / 2), width, 1.0) << nameOf(mode);
      EXPECT_EQ(inkOfRow(frame->image, kSize / 2, 80, 176), 0.0) << nameOf(mode);
    }
  }
}

TEST_P(ShaderLinesOn, OnlyImageEdgesKnowTheCreasesOfACube) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 30, 20);
  const PolylineSet edges = boxEdges(cube);
  for (const DrawMode mode : kModes) {
    const auto frame = renderer->render(cube, {}, camera, blackOnWhite(kSize, mode));
    ASSERT_TRUE(frame) << nameOf(mode) << ": " << frame.error().message;
    int drawn = 0;
    for (const PolylineSet::Line& line : edges.lines) {
      int inked = 0;
      for (int i = 1; i < 20; ++i) {
        const glm::dvec3 place = glm::mix(
            glm::dvec3(edges.points[line.begin]),
            glm::dvec3(edges.points[line.begin + 1]),
            i / 20.0);
        inked += isInkedNear(frame->image, cube, camera, place) ? 1 : 0;
      }
      drawn += inked == 19 ? 1 : 0;
    }
    EXPECT_EQ(drawn, mode == DrawMode::kImageEdges ? 9 : 6) << nameOf(mode);
  }
}

TEST_P(ShaderLinesOn, GeometryShaderAndFallbackDrawTheSame) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot bumpy = snapshotOf(primitives::bumpySphere(4, 5));
  MeshSnapshot hills = snapshotOf(primitives::openGrid(30, 20));
  hills.model.closed = false;
  for (const MeshSnapshot& snapshot : {bumpy, hills}) {
    const Camera camera = orbitCamera(snapshot.model.sphere, 40, 25);
    for (const bool hasLight : {false, true}) {
      RenderOptions options = blackOnWhite(kSize, DrawMode::kGeometryShader);
      if (hasLight) options.light = camera.eye + 3.0 * snapshot.model.sphere.radius * camera.up;
      const auto a = renderer->render(snapshot, {}, camera, options);
      options.draw = DrawMode::kConditionalLines;
      const auto b = renderer->render(snapshot, {}, camera, options);
      ASSERT_TRUE(a && b);
      EXPECT_GT(totalInk(a->image), 300.0);
      int differ = 0;
      for (std::size_t i = 0; i < a->image.rgba.size(); ++i)
        differ += std::abs(a->image.rgba[i] - b->image.rgba[i]) > 40 ? 1 : 0;
      EXPECT_LE(differ, 40);  // an edge seen exactly from its face's plane may be on either side
    }
  }
}

TEST_P(ShaderLinesOn, ALightsSilhouetteIsWhereItsRaysTouch) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(5));
  const BoundingSphere& model = sphere.model.sphere;
  const Camera camera = orbitCamera(model, 0, 0);
  // From straight above, far away: the equator, a horizontal line through the picture's middle.
  RenderOptions options = blackOnWhite(kSize, DrawMode::kGeometryShader);
  options.light = model.center + glm::dvec3(0.0, 1000.0 * model.radius, 0.0);
  options.lineColor = glm::vec3(1.0F, 0.0F, 0.0F);
  const auto frame = renderer->render(sphere, {}, camera, options);
  ASSERT_TRUE(frame) << frame.error().message;
  for (int x = 30; x < kSize - 30; ++x) {
    bool isRed = false;
    for (int y = kSize / 2 - 4; y < kSize / 2 + 4; ++y) {
      const std::uint8_t* p = &frame->image.rgba[4 * static_cast<std::size_t>(y * kSize + x)];
      isRed = isRed || (p[0] > 200 && p[1] < 80);
    }
    ASSERT_TRUE(isRed) << "a gap at column " << x;
  }
  // Lit from there: light above the line, dark below.
  EXPECT_LT(darkness(frame->image, kSize / 2, 60), darkness(frame->image, kSize / 2, 190));
}

TEST_P(ShaderLinesOn, BordersAreLines) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  MeshSnapshot grid = snapshotOf(primitives::openGrid(12, 12));
  grid.model.closed = false;
  const Camera camera = orbitCamera(grid.model.sphere, 0, 60);
  for (const DrawMode mode : kModes) {
    const auto frame = renderer->render(grid, {}, camera, blackOnWhite(kSize, mode));
    ASSERT_TRUE(frame) << nameOf(mode) << ": " << frame.error().message;
    const HalfEdgeMesh& mesh = grid.mesh.mesh();
    int missing = 0;
    for (std::uint32_t v = 0; v < mesh.vertexCount(); ++v) {
      if (!mesh.isBorderVertex(v)) continue;
      missing +=
          isInkedNear(frame->image, grid, camera, glm::dvec3(grid.mesh.positions()[v])) ? 0 : 1;
    }
    EXPECT_LE(missing, 4) << nameOf(mode);  // hills may hide a little of the far border
  }
}

TEST_P(ShaderLinesOn, AnyViewOfAnyMeshIsDrawn) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(2));
  Camera inside = orbitCamera(sphere.model.sphere, 25, 35, 0.3);
  fitDepthRange(sphere.model.sphere, inside);
  Camera flat = orbitCamera(sphere.model.sphere, 25, 35);
  flat.orthographic = true;
  MeshSnapshot nothing;
  nothing.revision = 9;
  for (const DrawMode mode : kModes) {
    EXPECT_TRUE(renderer->render(sphere, {}, inside, blackOnWhite(kSize, mode))) << nameOf(mode);
    EXPECT_TRUE(renderer->render(nothing, {}, inside, blackOnWhite(kSize, mode))) << nameOf(mode);
    const auto frame = renderer->render(sphere, {}, flat, blackOnWhite(kSize, mode));
    ASSERT_TRUE(frame) << nameOf(mode);
    EXPECT_GT(totalInk(frame->image), 500.0) << nameOf(mode);
  }
}

TEST_P(ShaderLinesOn, TheGeometryShaderIsUsedWhereItIsAskedFor) {
  auto context = createGlContext(GetParam());
  ASSERT_TRUE(context);
  auto tools = DrawTools::create((*context)->api());
  ASSERT_TRUE(tools);
  for (const DrawMode mode : {DrawMode::kGeometryShader, DrawMode::kConditionalLines}) {
    const auto method = EdgeLinesMethod::create(mode, *tools);
    ASSERT_TRUE(method) << method.error().message;
    // Mesa's software renderers, which the tests run on, have geometry shaders.
    EXPECT_EQ(
        dynamic_cast<const EdgeLinesMethod&>(**method).usesGeometryShader(),
        mode == DrawMode::kGeometryShader);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Backends,
    ShaderLinesOn,
    testing::Values(GlBackend::kEgl, GlBackend::kOsmesa),
    [](const auto& backend) { return backend.param == GlBackend::kEgl ? "Egl" : "Osmesa"; });

}  // namespace
}  // namespace limn
