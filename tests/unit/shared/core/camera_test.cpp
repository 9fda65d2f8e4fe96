// SPDX-License-Identifier: Apache-2.0
#include "shared/core/camera.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(Camera, OrbitLooksAtTheCentreFromTheAskedSide) {
  const BoundingSphere model{{1.0, 2.0, 3.0}, 2.0};
  const Camera camera = orbitCamera(model, 90.0, 0.0, 3.0);
  EXPECT_NEAR(camera.eye.x, 7.0, 1e-12);
  EXPECT_NEAR(camera.eye.y, 2.0, 1e-12);
  EXPECT_NEAR(camera.eye.z, 3.0, 1e-12);
  const glm::dvec4 clip = camera.clipFromWorld(1.0) * glm::dvec4(model.center, 1.0);
  const glm::dvec3 pixel = pixelFromClip(clip, {640, 480});
  EXPECT_NEAR(pixel.x, 320.0, 1e-9);
  EXPECT_NEAR(pixel.y, 240.0, 1e-9);
}

TEST(Camera, UpIsUpOnTheScreenAlsoFromThePoles) {
  const BoundingSphere model{{0.0, 0.0, 0.0}, 1.0};
  for (const double elevation : {0.0, 45.0, 90.0, -90.0}) {
    const Camera camera = orbitCamera(model, 0.0, elevation);
    const glm::dvec4 clip = camera.clipFromWorld(1.0) * glm::dvec4(0.2 * camera.up, 1.0);
    EXPECT_LT(pixelFromClip(clip, {100, 100}).y, 50.0) << elevation;
  }
}

TEST(Camera, OrthographicHasTheSameExtentAtTheTarget) {
  const BoundingSphere model{{0.0, 0.0, 0.0}, 1.0};
  Camera camera = orbitCamera(model, 30.0, 20.0);
  const glm::dvec4 point(
      0.3 * camera.up - glm::dot(0.3 * camera.up, camera.forward()) * camera.forward(),
      1.0);
  const glm::dvec3 perspective = pixelFromClip(camera.clipFromWorld(1.0) * point, {100, 100});
  camera.orthographic = true;
  fitDepthRange(model, camera);
  const glm::dvec3 orthographic = pixelFromClip(camera.clipFromWorld(1.0) * point, {100, 100});
  EXPECT_NEAR(perspective.y, orthographic.y, 1e-9);
}

}  // namespace
}  // namespace limn
