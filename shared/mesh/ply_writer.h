// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/triangle_mesh.h"

#include <span>
#include <string>

namespace limn {

/// A binary little-endian PLY file: a vertex has double x, y, z in model units and int qx, qy, qz
/// on the grid; where the mesh has them uchar red, green, blue (sRGB) and float nx, ny, nz; faces
/// are int32 index lists. What --dump-mesh writes, on both sides.
[[nodiscard]] std::string encodePly(
    const Grid& grid,
    std::span<const glm::ivec3> positions,
    std::span<const glm::uvec3> triangles,
    const AttributeArrays& attributes = {});

}  // namespace limn
