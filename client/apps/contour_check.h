// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/report.h"
#include "client/stroke/chain/polyline.h"

#include "shared/core/camera.h"
#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Points about half a pixel apart along the visible silhouette segments, in pixels. visible: one a
/// point of `lines`, see segmentVisibility().
[[nodiscard]] std::vector<glm::dvec2> visibleSilhouettePixels(
    const PolylineSet& lines,
    std::span<const std::uint8_t> visible,
    const Grid& grid,
    const Camera& camera,
    const Viewport& viewport);

/// How far two contours are apart: the distances from each point of one to the nearest of the
/// other, both ways; of each measure the worse way. Both empty: 0. One empty: the picture's
/// diagonal. Cost: about O(points).
[[nodiscard]] ContourError compareContours(
    std::span<const glm::dvec2> a,
    std::span<const glm::dvec2> b,
    const Viewport& viewport);

}  // namespace limn
