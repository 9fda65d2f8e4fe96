// SPDX-License-Identifier: Apache-2.0
#include "client/view/orbit_controls.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

constexpr double kHomeRadii = 3.0;
constexpr double kNearestRadii = 0.01;
constexpr double kFarthestRadii = 50.0;
constexpr double kStep = 0.9;
constexpr double kFlightSeconds = 0.4;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

struct Screen {
  glm::dvec3 right, up;
};

Screen screenOf(const Camera& camera) {
  const glm::dvec3 right = glm::normalize(glm::cross(camera.forward(), camera.up));
  return {right, glm::cross(right, camera.forward())};
}

/// Right and up of the picture's middle.
glm::dvec2 fromMiddle(const glm::dvec2& pixel, const Viewport& viewport) {
  return {pixel.x - 0.5 * viewport.width, 0.5 * viewport.height - pixel.y};
}

double extentPerPixel(const Camera& camera, double distance, const Viewport& viewport) {
  return 2.0 * distance * std::tan(0.5 * radians(camera.fovDegrees)) / viewport.height;
}

}  // namespace

OrbitControls::OrbitControls(const BoundingSphere& model) : model_(model) {
  home();
}

void OrbitControls::home() {
  flight_.reset();
  target_ = model_.center;
  azimuthDegrees_ = 30.0;
  elevationDegrees_ = 20.0;
  distance_ = kHomeRadii * model_.radius;
}

void OrbitControls::look(const Camera& camera) {
  flight_.reset();
  target_ = camera.target;
  const glm::dvec3 away = camera.eye - camera.target;
  distance_ = glm::length(away);
  elevationDegrees_ = degrees(std::asin(std::clamp(away.y / distance_, -1.0, 1.0)));
  azimuthDegrees_ = degrees(std::atan2(away.x, away.z));
  fovDegrees_ = camera.fovDegrees;
  orthographic_ = camera.orthographic;
}

void OrbitControls::rotate(const glm::dvec2& pixels, const Viewport& viewport) {
  flight_.reset();
  const double degreesPerPixel = 180.0 / viewport.height;
  azimuthDegrees_ = std::remainder(azimuthDegrees_ - degreesPerPixel * pixels.x, 360.0);
  elevationDegrees_ = std::clamp(elevationDegrees_ + degreesPerPixel * pixels.y, -90.0, 90.0);
}

void OrbitControls::pan(const glm::dvec2& pixels, const Viewport& viewport) {
  flight_.reset();
  const Screen screen = screenOf(camera());
  target_ += unitsPerPixel(viewport) * (pixels.y * screen.up - pixels.x * screen.right);
}

void OrbitControls::zoom(double steps, const glm::dvec2& pointer, const Viewport& viewport) {
  flight_.reset();
  const Screen screen = screenOf(camera());
  const glm::dvec2 offset = unitsPerPixel(viewport) * fromMiddle(pointer, viewport);
  const double before = distance_;
  distance_ = std::clamp(
      distance_ * std::pow(kStep, steps),
      kNearestRadii * model_.radius,
      kFarthestRadii * model_.radius);
  target_ += (1.0 - distance_ / before) * (offset.x * screen.right + offset.y * screen.up);
}

void OrbitControls::flyTo(const glm::dvec3& point, double nowSeconds) {
  const double closer = std::max(0.5 * distance_, kNearestRadii * model_.radius);
  flight_ = Flight{target_, point, distance_, closer, nowSeconds};
}

bool OrbitControls::animate(double nowSeconds) {
  if (!flight_) return false;
  const double t = std::clamp((nowSeconds - flight_->startSeconds) / kFlightSeconds, 0.0, 1.0);
  const double eased = t * t * (3.0 - 2.0 * t);
  target_ = glm::mix(flight_->fromTarget, flight_->toTarget, eased);
  distance_ = flight_->fromDistance * std::pow(flight_->toDistance / flight_->fromDistance, eased);
  if (t >= 1.0) flight_.reset();
  return true;
}

double OrbitControls::unitsPerPixel(const Viewport& viewport) const {
  return extentPerPixel(camera(), distance_, viewport);
}

Camera OrbitControls::camera() const {
  Camera camera =
      orbitCamera({target_, distance_}, azimuthDegrees_, elevationDegrees_, 1.0, fovDegrees_);
  camera.orthographic = orthographic_;
  fitDepthRange(model_, camera);
  return camera;
}

PixelRay rayThrough(const Camera& camera, const glm::dvec2& pixel, const Viewport& viewport) {
  const Screen screen = screenOf(camera);
  const double distance = glm::length(camera.target - camera.eye);
  const glm::dvec2 offset =
      extentPerPixel(camera, distance, viewport) * fromMiddle(pixel, viewport);
  const glm::dvec3 across = offset.x * screen.right + offset.y * screen.up;
  if (camera.orthographic) return {camera.eye + across, camera.forward()};
  return {camera.eye, glm::normalize(camera.target + across - camera.eye)};
}

}  // namespace limn
