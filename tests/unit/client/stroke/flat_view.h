// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_scene.h"

#include <cmath>

namespace limn {

/// Looks along −z at the plane z = 0, where one unit is one pixel and (0, 0) the picture's centre.
struct FlatView {
  FlatView() {
    camera.eye = {0.0, 0.0, 300.0};
    camera.orthographic = true;
    camera.fovDegrees = glm::degrees(2.0 * std::atan(100.0 / 300.0));
    camera.nearPlane = 1.0;
    camera.farPlane = 600.0;
    viewport = {200, 200};
  }

  [[nodiscard]] LineScene scene() const { return {mesh, positions, grid, camera, viewport}; }

  HalfEdgeMesh mesh;
  std::vector<glm::ivec3> positions;
  Grid grid;
  Camera camera;
  Viewport viewport;
};

}  // namespace limn
