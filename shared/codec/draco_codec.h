// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// A mesh as Draco codes it (edgebreaker, integer positions and attributes, lossless).
struct DracoMesh {
  std::vector<std::uint8_t> bytes;
  /// order[i]: index in the encoded mesh of the vertex that a decoder gives number i. Draco numbers
  /// vertices as its traversal meets them; the base mesh takes over that numbering.
  std::vector<std::uint32_t> order;
};

/// speed: Draco's 0 (smallest) to 10. Errors: kInvalidArgument for an empty mesh.
[[nodiscard]] Result<DracoMesh> encodeDraco(const TriangleMesh& mesh, int speed = 0);

/// Positions, triangles and the attributes that were coded; the grid is the caller's. Counts in the
/// header are checked against the limits before Draco runs. Errors: kCorrupt, kLimitExceeded.
[[nodiscard]] Result<TriangleMesh>
decodeDraco(std::span<const std::uint8_t> bytes, std::uint32_t maxVertices, std::uint32_t maxFaces);

}  // namespace limn
