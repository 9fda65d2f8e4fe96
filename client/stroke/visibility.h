// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/depth_image.h"
#include "client/stroke/polyline.h"

#include "shared/core/camera.h"
#include "shared/mesh/half_edge.h"
#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// The mesh that lines were found on, as a picture sees it.
struct LineScene {
  const HalfEdgeMesh& mesh;
  std::span<const glm::ivec3> positions;  // by slot, on the grid
  const Grid& grid;
  const Camera& camera;
  Viewport viewport;
};

/// Per-segment visibility, the CPU's counterpart of the renderer's visibility pass: the same spine
/// samples, the same 8-neighbourhood test, the same filter along the spine.
/// depth: the same mesh seen through the same camera (Frame::depth), of any size with that aspect.
/// Returns one entry a point: 1 if most of the segment that starts there is visible (0 for the last
/// point of an open line, and for segments outside the picture). Cost: O(length in pixels).
[[nodiscard]] std::vector<std::uint8_t>
segmentVisibility(const PolylineSet& lines, const LineScene& scene, const DepthImage& depth);

}  // namespace limn
