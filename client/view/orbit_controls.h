// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"

#include <glm/glm.hpp>

#include <optional>

namespace limn {

/// A camera that a pointer turns around a point, slides, and brings closer; up stays up. Sizes and
/// places in model units, pointer places in pixels from the top left. No clock: the time is an
/// argument. Threads: one at a time.
class OrbitControls {
 public:
  /// The whole model in view.
  explicit OrbitControls(const BoundingSphere& model);

  /// Back to where it began; the lens stays.
  void home();
  /// Takes over a camera; its roll is lost.
  void look(const Camera& camera);

  /// Turns as if the pointer held the model: half a turn for the picture's height.
  void rotate(const glm::dvec2& pixels, const Viewport& viewport);
  /// Slides so that the point looked at follows the pointer.
  void pan(const glm::dvec2& pixels, const Viewport& viewport);
  /// Each step comes a tenth closer (negative: goes away) to what lies under the pointer, at the
  /// distance of the point looked at.
  void zoom(double steps, const glm::dvec2& pointer, const Viewport& viewport);
  /// Sets off towards `point`: it becomes the point looked at, from half as far.
  void flyTo(const glm::dvec3& point, double nowSeconds);

  /// Moves a flight on. Returns whether one is under way.
  bool animate(double nowSeconds);

  void setFov(double degrees) { fovDegrees_ = degrees; }

  void setOrthographic(bool orthographic) { orthographic_ = orthographic; }

  [[nodiscard]] Camera camera() const;

 private:
  struct Flight {
    glm::dvec3 fromTarget, toTarget;
    double fromDistance, toDistance;
    double startSeconds;
  };

  /// Model units a pixel at the point looked at.
  [[nodiscard]] double unitsPerPixel(const Viewport& viewport) const;

  BoundingSphere model_;
  glm::dvec3 target_{0.0};
  double azimuthDegrees_ = 30.0;
  double elevationDegrees_ = 20.0;
  double distance_ = 1.0;
  double fovDegrees_ = 40.0;
  bool orthographic_ = false;
  std::optional<Flight> flight_;
};

/// The ray's origin and direction (unit) through a pixel.
struct PixelRay {
  glm::dvec3 origin;
  glm::dvec3 direction;
};

[[nodiscard]] PixelRay
rayThrough(const Camera& camera, const glm::dvec2& pixel, const Viewport& viewport);

}  // namespace limn
