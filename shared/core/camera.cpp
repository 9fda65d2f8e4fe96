// SPDX-License-Identifier: Apache-2.0
#include "shared/core/camera.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace limn {

glm::dvec3 Camera::forward() const {
  return glm::normalize(target - eye);
}

glm::dmat4 Camera::viewFromWorld() const {
  return glm::lookAt(eye, target, up);
}

glm::dmat4 Camera::clipFromView(double aspect) const {
  const double tanHalf = std::tan(glm::radians(fovDegrees) / 2.0);
  if (!orthographic) {
    return glm::perspective(glm::radians(fovDegrees), aspect, nearPlane, farPlane);
  }
  const double halfHeight = tanHalf * glm::distance(eye, target);
  const double halfWidth = halfHeight * aspect;
  return glm::ortho(-halfWidth, halfWidth, -halfHeight, halfHeight, nearPlane, farPlane);
}

glm::dmat4 Camera::clipFromWorld(double aspect) const {
  return clipFromView(aspect) * viewFromWorld();
}

Camera orbitCamera(
    const BoundingSphere& model,
    double azimuthDegrees,
    double elevationDegrees,
    double distanceRadii,
    double fovDegrees) {
  const double azimuth = glm::radians(azimuthDegrees);
  const double elevation = glm::radians(elevationDegrees);
  const glm::dvec3 direction(
      std::cos(elevation) * std::sin(azimuth),
      std::sin(elevation),
      std::cos(elevation) * std::cos(azimuth));
  Camera camera;
  camera.target = model.center;
  camera.eye = model.center + distanceRadii * model.radius * direction;
  camera.fovDegrees = fovDegrees;
  // Looking along y, "up" needs another axis; 1e-6 is far below any angle a user can type.
  if (std::abs(direction.y) > 1.0 - 1e-12) {
    camera.up = {0.0, 0.0, direction.y > 0.0 ? -1.0 : 1.0};
  }
  fitDepthRange(model, camera);
  return camera;
}

void fitDepthRange(const BoundingSphere& model, Camera& camera) {
  const double depth = glm::dot(model.center - camera.eye, camera.forward());
  const double slack = 1.01 * model.radius;
  camera.farPlane = std::max(depth + slack, 1e-3 * model.radius);
  camera.nearPlane = std::max(depth - slack, 1e-3 * camera.farPlane);
  if (camera.orthographic) camera.nearPlane = depth - slack;
}

glm::dvec3 pixelFromClip(const glm::dvec4& clip, const Viewport& viewport) {
  const glm::dvec3 ndc = glm::dvec3(clip) / clip.w;
  return {
      (ndc.x + 1.0) * 0.5 * viewport.width,
      (1.0 - ndc.y) * 0.5 * viewport.height,
      (ndc.z + 1.0) * 0.5};
}

}  // namespace limn
