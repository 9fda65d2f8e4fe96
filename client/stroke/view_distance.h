// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"

#include <algorithm>
#include <cmath>

namespace limn {

/// Distance from the eye along the view of a window depth, model units.
[[nodiscard]] inline float viewDistance(const Camera& camera, float depth) {
  const double n = camera.nearPlane;
  const double f = camera.farPlane;
  if (camera.orthographic) return static_cast<float>(n + depth * (f - n));
  return static_cast<float>(n * f / std::max(f - depth * (f - n), 1e-12));
}

/// Pixels that a model unit takes in the picture at a distance along the view (orthographic: at
/// any).
[[nodiscard]] inline float
pixelsPerUnit(const Camera& camera, const Viewport& viewport, double distance) {
  const double at = camera.orthographic ? glm::distance(camera.eye, camera.target) : distance;
  return static_cast<float>(
      0.5 * viewport.height /
      (std::tan(0.5 * glm::radians(camera.fovDegrees)) * std::max(at, 1e-9)));
}

}  // namespace limn
