// SPDX-License-Identifier: Apache-2.0
#include "client/render/renderer.h"

#include "tests/unit/client/render/scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace limn {
namespace {

RenderOptions inkAt(int size) {
  RenderOptions options;
  options.viewport = {size, size};
  options.style = "ink";
  return options;
}

class RendererOn : public testing::TestWithParam<GlBackend> {};

TEST_P(RendererOn, ASpheresOutlineIsACircleWithinOnePixel) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(5));
  const Camera camera = orbitCamera(sphere.model.sphere, 25, 35);
  const auto frame = renderer->render(
      sphere,
      silhouetteOf(sphere, camera, SilhouetteKind::kSmooth),
      camera,
      inkAt(512));
  ASSERT_TRUE(frame) << frame.error().message;
  // Seen from D radii the contour's angle has sine 1/D.
  const double tangent = std::tan(std::asin(1.0 / 3.0));
  const double radius = 256.0 * tangent / std::tan(glm::radians(20.0));
  for (int step = 0; step < 360; ++step) {
    const double angle = step * std::numbers::pi / 180.0;
    // The darkness along a ray, weighed: the line's middle; and enough of it to be a line.
    double weight = 0.0;
    double sum = 0.0;
    for (double r = radius - 8.0; r <= radius + 8.0; r += 0.25) {
      const int x = static_cast<int>(256.0 + r * std::cos(angle));
      const int y = static_cast<int>(256.0 + r * std::sin(angle));
      if (x < 0 || y < 0 || x > 511 || y > 511) continue;
      const int dark = darkness(frame->image, x, y);
      weight += dark;
      sum += dark * r;
    }
    ASSERT_GT(weight, 4.0 * 200.0) << "a gap at " << step << " degrees";
    ASSERT_NEAR(sum / weight, radius, 1.0) << "at " << step << " degrees";
  }
}

/// Share of the pixels on a line between two grid points that are inked.
double inked(
    const Image& image,
    const MeshSnapshot& snapshot,
    const Camera& camera,
    const glm::vec3& from,
    const glm::vec3& to) {
  const Viewport viewport{image.width, image.height};
  const glm::dmat4 clip = camera.clipFromWorld(viewport.aspect());
  int dark = 0;
  int all = 0;
  for (double t = 0.1; t <= 0.9; t += 0.002) {
    const glm::dvec3 p = snapshot.model.grid.origin +
                         snapshot.model.grid.step * (glm::dvec3(from) + t * glm::dvec3(to - from));
    const glm::dvec3 pixel = pixelFromClip(clip * glm::dvec4(p, 1.0), viewport);
    int best = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        best = std::max(
            best,
            darkness(image, static_cast<int>(pixel.x) + dx, static_cast<int>(pixel.y) + dy));
      }
    }
    dark += best > 60 ? 1 : 0;
    ++all;
  }
  return static_cast<double>(dark) / all;
}

TEST_P(RendererOn, ACubesHiddenEdgesAreDashedAndTheOthersSolid) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 30, 20);
  const PolylineSet lines = boxEdges(cube);
  ASSERT_EQ(lines.lines.size(), 12U);
  RenderOptions options = inkAt(512);
  int solid = 0;
  int dashed = 0;
  const auto frame = renderer->render(cube, lines, camera, options);
  ASSERT_TRUE(frame) << frame.error().message;
  for (const PolylineSet::Line& line : lines.lines) {
    const double share =
        inked(frame->image, cube, camera, lines.points[line.begin], lines.points[line.begin + 1]);
    if (share > 0.97) ++solid;
    if (share > 0.45 && share < 0.85) ++dashed;
  }
  EXPECT_EQ(solid, 9);
  EXPECT_EQ(dashed, 3);

  options.hidden = HiddenLines::kOff;
  const auto without = renderer->render(cube, lines, camera, options);
  ASSERT_TRUE(without);
  options.hidden = HiddenLines::kAsVisible;
  const auto all = renderer->render(cube, lines, camera, options);
  ASSERT_TRUE(all);
  int absent = 0;
  for (const PolylineSet::Line& line : lines.lines) {
    const glm::vec3 a = lines.points[line.begin];
    const glm::vec3 b = lines.points[line.begin + 1];
    // The three hidden edges are crossed by visible ones at most once.
    if (inked(without->image, cube, camera, a, b) < 0.1) ++absent;
    EXPECT_GT(inked(all->image, cube, camera, a, b), 0.97);
  }
  EXPECT_EQ(absent, 3);
}

TEST_P(RendererOn, CrowdedHiddenLinesAreMuchPalerThanFew) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 0, 0);
  glm::vec3 low(cube.mesh.positions()[0]);
  glm::vec3 high = low;
  for (const glm::ivec3& p : cube.mesh.positions()) {
    low = glm::min(low, glm::vec3(p));
    high = glm::max(high, glm::vec3(p));
  }
  // Level lines through the middle of the cube, all behind its front.
  const auto darkest = [&](int count) {
    PolylineSet lines;
    for (int i = 0; i < count; ++i) {
      const auto begin = static_cast<std::uint32_t>(lines.points.size());
      for (const float x : {0.2F, 0.8F}) {
        const float y = 0.5F + 0.01F * static_cast<float>(i - count / 2);
        lines.points.push_back(glm::mix(low, high, glm::vec3(x, y, 0.5F)));
        lines.halfEdges.push_back(kNone);
        lines.faces.push_back(kNone);
      }
      lines.lines.push_back({LineKind::kCrease, false, begin, begin + 2});
    }
    const auto frame = renderer->render(cube, lines, camera, inkAt(512));
    EXPECT_TRUE(frame);
    int best = 0;
    for (int x = 200; frame && x < 312; ++x) {
      for (int y = 250; y < 262; ++y)
        best = std::max(best, darkness(frame->image, x, y));
    }
    return best;
  };
  const int alone = darkest(1);
  EXPECT_GT(alone, 60);
  EXPECT_LT(2 * darkest(60), alone);
}

TEST_P(RendererOn, AHiddenLineThatRunsAlongAVisibleOneIsLeftOut) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 0, 0);
  const RenderOptions options = inkAt(512);
  const glm::dmat4 worldFromClip = glm::inverse(camera.clipFromWorld(1.0));
  // One level line in front of the cube, and one inside of it so many pixels below that.
  const auto inkOfHidden = [&](double belowPx) {
    PolylineSet lines;
    for (const glm::dvec2 place : {glm::dvec2(200.0, -0.9), glm::dvec2(200.0 + belowPx, 0.3)}) {
      const auto begin = static_cast<std::uint32_t>(lines.points.size());
      for (const double x : {180.0, 330.0}) {
        const glm::dvec4 world =
            worldFromClip * glm::dvec4(x / 256.0 - 1.0, 1.0 - place.x / 256.0, place.y, 1.0);
        lines.points.push_back(cube.model.grid.fromModel(glm::dvec3(world) / world.w));
        lines.halfEdges.push_back(kNone);
        lines.faces.push_back(kNone);
      }
      lines.lines.push_back({LineKind::kBorder, false, begin, begin + 2});
    }
    const auto with = renderer->render(cube, lines, camera, options);
    RenderOptions off = options;
    off.hidden = HiddenLines::kOff;
    const auto without = renderer->render(cube, lines, camera, off);
    EXPECT_TRUE(with && without);
    int ink = 0;
    for (int y = 190; with && without && y < 230; ++y) {
      for (int x = 200; x < 310; ++x)
        ink += darkness(with->image, x, y) - darkness(without->image, x, y);
    }
    return ink;
  };
  EXPECT_GT(inkOfHidden(12.0), 4000);
  EXPECT_EQ(inkOfHidden(3.0), 0);
}

/// Adds a straight line in front of everything. from, to: pixels.
void addInFront(
    const MeshSnapshot& snapshot,
    const Camera& camera,
    const Viewport& viewport,
    const glm::vec2& from,
    const glm::vec2& to,
    PolylineSet& lines) {
  const glm::dmat4 worldFromClip = glm::inverse(camera.clipFromWorld(viewport.aspect()));
  const auto begin = static_cast<std::uint32_t>(lines.points.size());
  for (const glm::dvec2 p : {from, to}) {
    const glm::dvec4 world =
        worldFromClip *
        glm::dvec4(2.0 * p.x / viewport.width - 1.0, 1.0 - 2.0 * p.y / viewport.height, -0.9, 1.0);
    lines.points.push_back(snapshot.model.grid.fromModel(glm::dvec3(world) / world.w));
    lines.halfEdges.push_back(kNone);
    lines.faces.push_back(kNone);
  }
  lines.lines.push_back({LineKind::kBorder, false, begin, begin + 2});
}

/// Mean darkness of the picture's middle, from upright lines in front of everything.
double toneOfLines(Renderer& renderer, float spacingPx, const RenderOptions& options) {
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 0, 0);
  const Viewport& viewport = options.viewport;
  const auto width = static_cast<float>(viewport.width);
  PolylineSet lines;
  for (float x = 0.2F * width; x < 0.8F * width; x += spacingPx)
    addInFront(cube, camera, viewport, {x, 0.1F * width}, {x, 0.9F * width}, lines);
  const auto frame = renderer.render(cube, lines, camera, options);
  EXPECT_TRUE(frame);
  if (!frame) return 0.0;
  const int from = 2 * viewport.width / 5;
  const int to = 3 * viewport.width / 5;
  double sum = 0.0;
  for (int y = from; y < to; ++y) {
    for (int x = from; x < to; ++x)
      sum += darkness(frame->image, x, y);
  }
  return sum / (to - from) / (to - from);
}

TEST_P(RendererOn, VisibleLinesThatCrowdLeavePaperBetweenThem) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const double black = 255.0;
  // As wide as they are where there is room.
  const double few = toneOfLines(*renderer, 20.0F, inkAt(256));
  EXPECT_NEAR(few / black, 2.6 / 20.0, 0.03);
  for (const float spacing : {4.0F, 3.0F, 2.2F})
    EXPECT_LT(toneOfLines(*renderer, spacing, inkAt(256)) / black, 0.65) << spacing;
}

TEST_P(RendererOn, AVisiblePartEndsInARoundOfItsOwnWidthPastWhereItGoesHidden) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 0, 0);
  RenderOptions options = inkAt(512);
  options.hidden = HiddenLines::kOff;
  options.widthPx = 8.0;
  // From the left into the middle of the cube; where its outline is comes from the depth image.
  options.keepDepth = true;
  PolylineSet lines;
  const glm::dmat4 worldFromClip = glm::inverse(camera.clipFromWorld(1.0));
  for (const double x : {20.0, 256.0}) {
    const glm::dvec4 world = worldFromClip * glm::dvec4(x / 256.0 - 1.0, 0.0, 0.3, 1.0);
    lines.points.push_back(cube.model.grid.fromModel(glm::dvec3(world) / world.w));
    lines.halfEdges.push_back(kNone);
    lines.faces.push_back(kNone);
  }
  lines.lines.push_back({LineKind::kBorder, false, 0, 2});
  const auto frame = renderer->render(cube, lines, camera, options);
  ASSERT_TRUE(frame) << frame.error().message;
  const int fineness = frame->depth.width / 512;
  int outline = 20;
  while (frame->depth.at(fineness * outline, fineness * 256) == 1.0F)
    ++outline;
  int last = 20;
  while (std::max(darkness(frame->image, last, 255), darkness(frame->image, last, 256)) > 100)
    ++last;
  EXPECT_GE(last, outline + 2);
  EXPECT_LE(last, outline + 5);
}

TEST_P(RendererOn, ALineThatFadesIsThinnerAndNotPaler) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 0, 0);
  const RenderOptions options = inkAt(512);
  PolylineSet lines;
  addInFront(cube, camera, options.viewport, {100.5F, 40.0F}, {100.5F, 470.0F}, lines);
  addInFront(cube, camera, options.viewport, {300.5F, 200.0F}, {300.5F, 215.0F}, lines);
  const auto frame = renderer->render(cube, lines, camera, options);
  ASSERT_TRUE(frame) << frame.error().message;
  // Across the middle of the short one: how dark it is, and how wide at that darkness.
  const auto across = [&](int x) {
    int darkest = 0;
    int ink = 0;
    for (int i = x - 6; i <= x + 6; ++i) {
      ink += darkness(frame->image, i, 207);
      darkest = std::max(darkest, darkness(frame->image, i, 207));
    }
    return std::pair(darkest, static_cast<double>(ink) / darkest);
  };
  const auto [fullDarkness, fullWidth] = across(100);
  const auto [darkness, width] = across(300);
  EXPECT_GT(darkness, fullDarkness / 2);
  EXPECT_LT(width, 0.75 * fullWidth);
}

TEST_P(RendererOn, ACoarsePictureThatIsEnlargedHasTheSameStrokes) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  RenderOptions coarse = inkAt(256);
  coarse.pixelScale = 0.5;
  const double fine = toneOfLines(*renderer, 32.0F, inkAt(512));
  EXPECT_NEAR(toneOfLines(*renderer, 16.0F, coarse), fine, 0.1 * fine);
}

TEST_P(RendererOn, TheDepthImageIsTheMeshsDepth) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 0, 0);  // looks at the face z = max
  RenderOptions options = inkAt(128);
  options.keepDepth = true;
  const auto frame = renderer->render(cube, {}, camera, options);
  ASSERT_TRUE(frame) << frame.error().message;
  ASSERT_EQ(frame->depth.width, 256);
  const glm::dvec3 middle =
      cube.model.sphere.center + glm::dvec3(0, 0, cube.model.sphere.radius / std::sqrt(3.0));
  const glm::dvec3 pixel =
      pixelFromClip(camera.clipFromWorld(1.0) * glm::dvec4(middle, 1.0), {256, 256});
  EXPECT_NEAR(frame->depth.at(128, 128), pixel.z, 1e-4);
  EXPECT_EQ(frame->depth.at(2, 2), 1.0F);
}

TEST_P(RendererOn, ShadedDrawsTheMeshWhereItIs) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot sphere = snapshotOf(primitives::icosphere(4));
  const Camera camera = orbitCamera(sphere.model.sphere, 0, 0);
  RenderOptions options = inkAt(128);
  options.draw = DrawMode::kShaded;
  const auto frame = renderer->render(sphere, {}, camera, options);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_GT(darkness(frame->image, 64, 64), 20);
  EXPECT_EQ(darkness(frame->image, 1, 1), 0);
  // The light stands above the viewer's left shoulder.
  EXPECT_LT(darkness(frame->image, 44, 40), darkness(frame->image, 84, 88));
}

TEST_P(RendererOn, WhatCannotBeDrawnIsRefusedWithAReason) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  const MeshSnapshot cube = snapshotOf(primitives::cube());
  const Camera camera = orbitCamera(cube.model.sphere, 30, 20);
  RenderOptions options = inkAt(64);
  options.style = "crayon";
  auto frame = renderer->render(cube, {}, camera, options);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(frame.error().message.find("ink, marker"), std::string::npos) << frame.error().message;
  for (const Viewport viewport : {Viewport{0, 64}, Viewport{64, -1}, Viewport{1 << 20, 64}}) {
    options = inkAt(64);
    options.viewport = viewport;
    EXPECT_FALSE(renderer->render(cube, {}, camera, options));
  }
  options = inkAt(64);
  options.supersample = 9;
  EXPECT_FALSE(renderer->render(cube, {}, camera, options));
  // And it goes on working.
  EXPECT_TRUE(renderer->render(cube, {}, camera, inkAt(64)));
}

TEST_P(RendererOn, ANewRevisionReplacesTheMesh) {
  auto renderer = makeRenderer(GetParam());
  ASSERT_TRUE(renderer);
  MeshSnapshot cube = snapshotOf(primitives::cube());
  MeshSnapshot sphere = snapshotOf(primitives::icosphere(3));
  const Camera camera = orbitCamera(sphere.model.sphere, 0, 0);
  RenderOptions options = inkAt(64);
  options.keepDepth = true;
  const auto first = renderer->render(sphere, {}, camera, options);
  sphere.mesh = cube.mesh;
  ++sphere.revision;
  const auto second = renderer->render(sphere, {}, camera, options);
  ASSERT_TRUE(first && second);
  EXPECT_NE(first->depth.depth, second->depth.depth);
}

INSTANTIATE_TEST_SUITE_P(
    Backends,
    RendererOn,
    testing::Values(GlBackend::kEgl, GlBackend::kOsmesa),
    [](const auto& backend) { return backend.param == GlBackend::kEgl ? "Egl" : "Osmesa"; });

TEST(Renderer, BothBackendsDrawTheSamePicture) {
  const MeshSnapshot bumpy = snapshotOf(primitives::bumpySphere(4, 5));
  const Camera camera = orbitCamera(bumpy.model.sphere, 40, 10);
  const PolylineSet lines = silhouetteOf(bumpy, camera, SilhouetteKind::kSmooth);
  for (const char* style : {"ink", "pencil"}) {
    RenderOptions options = inkAt(256);
    options.style = style;
    const auto draw = [&](GlBackend backend) {
      auto renderer = makeRenderer(backend);
      auto frame = renderer ? renderer->render(bumpy, lines, camera, options)
                            : fail(ErrorCode::kUnavailable, "no renderer");
      EXPECT_TRUE(frame) << frame.error().message;
      return frame ? frame->image : Image{};
    };
    const Image a = draw(GlBackend::kEgl);
    const Image b = draw(GlBackend::kOsmesa);
    ASSERT_EQ(a.rgba.size(), 4U * 256U * 256U);
    ASSERT_EQ(b.rgba.size(), a.rgba.size());
    int inkPixels = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) {
      ASSERT_LE(std::abs(a.rgba[i] - b.rgba[i]), 4) << style << " byte " << i;
      inkPixels += a.rgba[i] < 128 ? 1 : 0;
    }
    EXPECT_GT(inkPixels, 500) << style;
  }
}

TEST(Renderer, SameInputSameBytes) {
  auto renderer = makeRenderer(GlBackend::kOsmesa);
  ASSERT_TRUE(renderer);
  const MeshSnapshot torus = snapshotOf(primitives::torus(60, 30));
  const Camera camera = orbitCamera(torus.model.sphere, 40, 30);
  const PolylineSet lines = silhouetteOf(torus, camera, SilhouetteKind::kEdges);
  const auto a = renderer->render(torus, lines, camera, inkAt(128));
  const auto b = renderer->render(torus, lines, camera, inkAt(128));
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->image.rgba, b->image.rgba);
}

TEST(Renderer, HiddenModesAreParsedAndOthersRefused) {
  EXPECT_EQ(parseHiddenLines("style").value(), HiddenLines::kStyle);
  EXPECT_EQ(parseHiddenLines("off").value(), HiddenLines::kOff);
  EXPECT_EQ(parseHiddenLines("as-visible").value(), HiddenLines::kAsVisible);
  EXPECT_FALSE(parseHiddenLines("dotted"));
}

}  // namespace
}  // namespace limn
