// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/line_scene.h"

#include "client/stroke/view_distance.h"

namespace limn {

glm::dmat4 clipFromGrid(const LineScene& scene) {
  const glm::dmat4 clipFromWorld = scene.camera.clipFromWorld(scene.viewport.aspect());
  glm::dmat4 m = clipFromWorld * scene.grid.step;
  m[3] = clipFromWorld * glm::dvec4(scene.grid.origin, 1.0);
  return m;
}

double pixelsPerGrid(const LineScene& scene, const glm::dvec3& place) {
  const glm::dvec3 fromEye = scene.grid.toModel(place) - scene.camera.eye;
  return scene.grid.step *
         pixelsPerUnit(scene.camera, scene.viewport, glm::dot(fromEye, scene.camera.forward()));
}

}  // namespace limn
