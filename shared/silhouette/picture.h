// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <algorithm>

namespace limn {

/// A camera and a picture in grid units: what contours are compared in.
struct PictureView {
  glm::dvec3 eye{0.0};
  glm::dvec3 right{1.0, 0.0, 0.0};  // unit, orthogonal
  glm::dvec3 up{0.0, 1.0, 0.0};
  glm::dvec3 forward{0.0, 0.0, -1.0};
  bool orthographic = false;
  /// A length across the view projects to length · pixelsPerUnit pixels (orthographic) or length ·
  /// pixelsPerUnit / depth.
  double pixelsPerUnit = 1.0;
  int width = 1024;
  int height = 1024;

  [[nodiscard]] SilhouetteView silhouetteView() const { return {eye, forward, orthographic}; }

  /// x, y: pixels, (0, 0) the top left; z: nearness, larger is nearer and linear across a projected
  /// plane: 1 / depth, or −depth of an orthographic view. z = 0 of a perspective view: not in front
  /// of the eye; x and y then mean nothing. All are finite, however absurd the view.
  [[nodiscard]] glm::dvec3 project(const glm::dvec3& p) const {
    const glm::dvec3 offset = p - eye;
    const double depth = glm::dot(offset, forward);
    if (!orthographic && !(depth >= 1e-3)) return glm::dvec3(0.0);
    const double scale = orthographic ? pixelsPerUnit : pixelsPerUnit / depth;
    return {
        bounded(0.5 * width + scale * glm::dot(offset, right), kFarPx),
        bounded(0.5 * height - scale * glm::dot(offset, up), kFarPx),
        bounded(orthographic ? -depth : 1.0 / depth, kFarNearness)};
  }

  /// Change of nearness when a point of nearness z comes nearer by a length.
  [[nodiscard]] double nearnessOf(double length, double z) const {
    return orthographic ? length : length * z * z;
  }

 private:
  /// Views may be as absurd as numbers allow (an eye 1e300 away): what follows rounds pixels to
  /// integers and multiplies them in single precision.
  static constexpr double kFarPx = 1e6;
  static constexpr double kFarNearness = 1e24;

  /// Not a number counts as −limit.
  static double bounded(double value, double limit) {
    return value > -limit ? std::min(value, limit) : -limit;
  }
};

}  // namespace limn
