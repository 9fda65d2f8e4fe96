// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Features (one byte a half-edge, EdgeFeature) and, as creases among them, the edges at which a
/// panel goes over into an outward rounding made of strips much narrower than it. A normal averaged
/// there would let the smooth silhouette of the rounding run through the panel, many pixels inside
/// the mesh's outline. For dividing normals only (CreaseContours), not for drawing. radius: of the
/// model, grid units. Threads: reentrant. Cost: O(faces), little where they are small.
[[nodiscard]] std::vector<std::uint8_t> withPanelEdges(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    std::vector<std::uint8_t> features,
    double radius);

}  // namespace limn
