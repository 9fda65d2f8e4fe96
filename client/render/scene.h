// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/stroke/chain/polyline.h"

#include "shared/core/camera.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace limn {

/// A model in a scene of several.
struct SceneObject {
  const MeshSnapshot& snapshot;
  const PolylineSet& lines;  // as Renderer::render()
  glm::dvec3 place{0.0};     // where its origin lies
};

/// The sphere of an object, in the scene.
[[nodiscard]] BoundingSphere sphereOf(const SceneObject& object);

/// A sphere around all of them; one object's is its own.
[[nodiscard]] BoundingSphere sphereAround(std::span<const BoundingSphere> spheres);

/// The scene's camera as a model at `place` sees it.
[[nodiscard]] Camera seenFrom(Camera camera, const glm::dvec3& place);

/// Indices in an order in which no sphere hides an earlier one from the eye. Right for any spheres
/// that do not meet: the plane of points with equal powers about two of them lies between them, and
/// the one of less power about the eye on the eye's side. Where spheres meet, the best guess.
[[nodiscard]] std::vector<std::size_t> farToNear(
    std::span<const BoundingSphere> spheres,
    const Camera& camera);

}  // namespace limn
