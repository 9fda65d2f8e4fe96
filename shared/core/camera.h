// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

namespace limn {

/// A pinhole or orthographic camera in model units, right-handed, OpenGL clip space, column
/// vectors.
struct Camera {
  glm::dvec3 eye{0.0, 0.0, 3.0};
  glm::dvec3 target{0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double fovDegrees = 40.0;   // vertical
  bool orthographic = false;  // same extent at `target` as the perspective camera has there
  double nearPlane = 0.1;
  double farPlane = 10.0;

  [[nodiscard]] glm::dvec3 forward() const;  // unit vector from eye to target
  [[nodiscard]] glm::dmat4 viewFromWorld() const;
  [[nodiscard]] glm::dmat4 clipFromView(double aspect) const;
  [[nodiscard]] glm::dmat4 clipFromWorld(double aspect) const;
};

/// The viewport a camera is seen through, in pixels.
struct Viewport {
  int width = 1024;
  int height = 1024;

  [[nodiscard]] double aspect() const { return static_cast<double>(width) / height; }
};

/// A sphere around the model: centre of its box, distance to its farthest vertex.
struct BoundingSphere {
  glm::dvec3 center{0.0};
  double radius = 1.0;
};

/// `orbit:AZIMUTH,ELEVATION,DISTANCE`: eye = c + D·r·(cos E·sin A, sin E, cos E·cos A), looking at
/// c, up +y (−z / +z at ±90° elevation). Angles in degrees, distance in radii.
[[nodiscard]] Camera orbitCamera(
    const BoundingSphere& model,
    double azimuthDegrees,
    double elevationDegrees,
    double distanceRadii = 3.0,
    double fovDegrees = 40.0);

/// Sets near and far so that the whole sphere lies between them with some slack; also from inside.
void fitDepthRange(const BoundingSphere& model, Camera& camera);

/// Pixel (0,0) is the top left; z is depth in [0, 1]. `clip` is clipFromWorld · (p, 1).
[[nodiscard]] glm::dvec3 pixelFromClip(const glm::dvec4& clip, const Viewport& viewport);

}  // namespace limn
