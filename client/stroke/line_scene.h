// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"
#include "shared/mesh/half_edge.h"
#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <span>

namespace limn {

/// The mesh that lines were found on, as a picture sees it. Refers to its parts: for the length of
/// a call.
struct LineScene {
  const HalfEdgeMesh& mesh;
  std::span<const glm::ivec3> positions;  // by slot, on the grid
  const Grid& grid;
  const Camera& camera;
  Viewport viewport;
};

/// clip space ← grid units.
[[nodiscard]] glm::dmat4 clipFromGrid(const LineScene& scene);

/// Pixels that a grid unit across the view takes in the picture at a place (grid units).
[[nodiscard]] double pixelsPerGrid(const LineScene& scene, const glm::dvec3& place);

}  // namespace limn
