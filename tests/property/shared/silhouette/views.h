// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/rng.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/silhouette/field.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace limn::testing {

/// `count` views in random directions, 0.6 to 20 radii from the model's centre; every fifth is
/// orthographic.
inline std::vector<SilhouetteView>
randomViews(const TriangleMesh& mesh, int count, std::uint64_t seed) {
  const BoundingSphere sphere = boundingSphere(mesh.grid, mesh.positions);
  const glm::dvec3 center = mesh.grid.fromModel(sphere.center);
  const double radius = sphere.radius / mesh.grid.step;
  Rng rng(seed);
  std::vector<SilhouetteView> views;
  for (int i = 0; i < count; ++i) {
    const double z = 2.0 * rng.uniform() - 1.0;
    const double angle = 2.0 * std::numbers::pi * rng.uniform();
    const double ring = std::sqrt(1.0 - z * z);
    const glm::dvec3 direction(ring * std::cos(angle), ring * std::sin(angle), z);
    const double distance = 0.6 * std::pow(20.0 / 0.6, rng.uniform());
    SilhouetteView view;
    view.eye = center + radius * distance * direction;
    view.forward = -direction;
    view.orthographic = i % 5 == 4;
    views.push_back(view);
  }
  return views;
}

/// `count` views on a circle around the model, `stepDegrees` apart.
inline std::vector<SilhouetteView>
orbitViews(const TriangleMesh& mesh, int count, double stepDegrees, double distanceRadii = 3.0) {
  const BoundingSphere sphere = boundingSphere(mesh.grid, mesh.positions);
  const glm::dvec3 center = mesh.grid.fromModel(sphere.center);
  const double radius = sphere.radius / mesh.grid.step;
  std::vector<SilhouetteView> views;
  for (int i = 0; i < count; ++i) {
    const double angle = i * stepDegrees * std::numbers::pi / 180.0;
    const glm::dvec3 direction = glm::normalize(glm::dvec3(std::sin(angle), 0.3, std::cos(angle)));
    SilhouetteView view;
    view.eye = center + radius * distanceRadii * direction;
    view.forward = -direction;
    views.push_back(view);
  }
  return views;
}

}  // namespace limn::testing
