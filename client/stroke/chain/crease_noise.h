// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/cracks.h"
#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Features without the creases that are noise of a scan: those that, with all creases they are
/// connected to, are short beside the mesh; and longer ones with loose ends that divide nothing,
/// such as a step between two scans: each side, with the surface that goes on from it nearby, faces
/// the same way as the other. Creases go on across cracks and along those that are creases.
/// features: one byte a half-edge (EdgeFeature), or none; cracks: Cracks::kinds, or none.
/// Cost: O(half-edges), and O(faces near) for each connected piece with loose ends.
[[nodiscard]] std::vector<std::uint8_t> withoutNoise(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    std::span<const std::uint8_t> features,
    std::span<const Crack> cracks = {});

}  // namespace limn
