// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. Sander, X. Gu, S. Gortler, H. Hoppe, J. Snyder, "Silhouette clipping", SIGGRAPH
// 2000, section 3: objects are sorted, and drawn from far to near.
#include "client/render/scene.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace limn {

BoundingSphere sphereOf(const SceneObject& object) {
  BoundingSphere sphere = object.snapshot.model.sphere;
  sphere.center += object.place;
  return sphere;
}

BoundingSphere sphereAround(std::span<const BoundingSphere> spheres) {
  glm::dvec3 low(std::numeric_limits<double>::max());
  glm::dvec3 high(std::numeric_limits<double>::lowest());
  for (const BoundingSphere& sphere : spheres) {
    low = glm::min(low, sphere.center - sphere.radius);
    high = glm::max(high, sphere.center + sphere.radius);
  }
  BoundingSphere around{0.5 * (low + high), 0.0};
  for (const BoundingSphere& sphere : spheres) {
    around.radius =
        std::max(around.radius, glm::distance(around.center, sphere.center) + sphere.radius);
  }
  return around;
}

Camera seenFrom(Camera camera, const glm::dvec3& place) {
  camera.eye -= place;
  camera.target -= place;
  return camera;
}

std::vector<std::size_t> farToNear(std::span<const BoundingSphere> spheres, const Camera& camera) {
  const auto distance = [&](std::size_t i) {
    const BoundingSphere& sphere = spheres[i];
    const glm::dvec3 from = sphere.center - camera.eye;
    if (camera.orthographic) return glm::dot(from, camera.forward());
    return glm::dot(from, from) - sphere.radius * sphere.radius;
  };
  std::vector<std::size_t> order(spheres.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater(), distance);
  return order;
}

}  // namespace limn
