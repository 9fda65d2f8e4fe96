// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// One byte a half-edge: kFeatureCrease (1) where the normals of its two faces differ by more than
/// the angle, else 0. Borders and edges of faces without area are none. Equal on twins.
[[nodiscard]] std::vector<std::uint8_t>
findCreases(const HalfEdgeMesh& mesh, std::span<const glm::ivec3> positions, double angleDegrees);

}  // namespace limn
