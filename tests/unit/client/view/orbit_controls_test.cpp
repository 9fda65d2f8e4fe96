// SPDX-License-Identifier: Apache-2.0
#include "client/view/orbit_controls.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limn {
namespace {

const BoundingSphere kModel{{5.0, -2.0, 1.0}, 4.0};
constexpr Viewport kScreen{800, 600};

glm::dvec2 pixelOf(const Camera& camera, const glm::dvec3& point) {
  const glm::dvec4 clip = camera.clipFromWorld(kScreen.aspect()) * glm::dvec4(point, 1.0);
  return glm::dvec2(pixelFromClip(clip, kScreen));
}

/// On the plane through the point looked at.
glm::dvec3 pointUnder(const Camera& camera, const glm::dvec2& pixel) {
  const PixelRay ray = rayThrough(camera, pixel, kScreen);
  const glm::dvec3 forward = camera.forward();
  const double t = glm::dot(camera.target - ray.origin, forward) / glm::dot(ray.direction, forward);
  return ray.origin + t * ray.direction;
}

void expectNear(const glm::dvec2& a, const glm::dvec2& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
}

TEST(OrbitControls, BeginWithTheViewThatRenderHas) {
  const Camera camera = OrbitControls(kModel).camera();
  const Camera usual = orbitCamera(kModel, 30.0, 20.0);
  EXPECT_NEAR(glm::length(camera.eye - usual.eye), 0.0, 1e-9);
  EXPECT_NEAR(glm::length(camera.target - usual.target), 0.0, 1e-9);
}

TEST(OrbitControls, TurningKeepsTheDistanceAndStopsAboveTheModel) {
  OrbitControls controls(kModel);
  const double distance = glm::length(controls.camera().eye - kModel.center);
  controls.rotate({100.0, 40.0}, kScreen);
  EXPECT_NEAR(glm::length(controls.camera().eye - kModel.center), distance, 1e-9);
  controls.rotate({0.0, 10'000.0}, kScreen);
  EXPECT_NEAR(controls.camera().eye.y, kModel.center.y + distance, 1e-9);
  EXPECT_TRUE(std::isfinite(controls.camera().viewFromWorld()[0][0]));
}

TEST(OrbitControls, ADragToTheRightTurnsTheFrontToTheRight) {
  OrbitControls controls(kModel);
  const Camera before = controls.camera();
  const glm::dvec3 front = kModel.center - 2.0 * before.forward();
  controls.rotate({30.0, 0.0}, kScreen);
  EXPECT_GT(pixelOf(controls.camera(), front).x, pixelOf(before, front).x);
}

TEST(OrbitControls, SlidingTakesThePointUnderThePointerAlong) {
  for (const bool isOrthographic : {false, true}) {
    OrbitControls controls(kModel);
    controls.setOrthographic(isOrthographic);
    const glm::dvec3 point = pointUnder(controls.camera(), {300.0, 200.0});
    controls.pan({50.0, -30.0}, kScreen);
    expectNear(pixelOf(controls.camera(), point), {350.0, 170.0}, 1e-6);
  }
}

TEST(OrbitControls, ComingCloserKeepsThePointUnderThePointer) {
  OrbitControls controls(kModel);
  const glm::dvec2 pointer(650.0, 120.0);
  const glm::dvec3 point = pointUnder(controls.camera(), pointer);
  const double before = glm::length(controls.camera().eye - controls.camera().target);
  controls.zoom(3.0, pointer, kScreen);
  expectNear(pixelOf(controls.camera(), point), pointer, 1e-6);
  EXPECT_LT(glm::length(controls.camera().eye - controls.camera().target), before);
  controls.zoom(1e6, pointer, kScreen);
  EXPECT_GT(glm::length(controls.camera().eye - controls.camera().target), 0.0);
}

TEST(OrbitControls, AFlightEndsWithThePointInTheMiddleFromHalfAsFar) {
  OrbitControls controls(kModel);
  const glm::dvec3 point = kModel.center + glm::dvec3(1.0, 2.0, 0.5);
  const double before = glm::length(controls.camera().eye - controls.camera().target);
  EXPECT_FALSE(controls.animate(10.0));
  controls.flyTo(point, 10.0);
  EXPECT_TRUE(controls.animate(10.1));
  EXPECT_TRUE(controls.animate(99.0));
  EXPECT_FALSE(controls.animate(99.1));
  expectNear(pixelOf(controls.camera(), point), {400.0, 300.0}, 1e-6);
  EXPECT_NEAR(glm::length(controls.camera().eye - point), 0.5 * before, 1e-9);
  controls.home();
  EXPECT_NEAR(glm::length(controls.camera().target - kModel.center), 0.0, 1e-12);
}

TEST(OrbitControls, TakeOverACamera) {
  OrbitControls controls(kModel);
  const Camera other = orbitCamera(kModel, -120.0, 55.0, 2.0, 25.0);
  controls.look(other);
  EXPECT_NEAR(glm::length(controls.camera().eye - other.eye), 0.0, 1e-9);
  EXPECT_EQ(controls.camera().fovDegrees, 25.0);
}

}  // namespace
}  // namespace limn
