// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/triangle_mesh.h"

#include <cstdint>
#include <string>

namespace limn {

/// What simplification cannot take away.
struct MeshTopology {
  std::uint32_t pieces = 0;   // connected components
  std::uint32_t holes = 0;    // border loops
  std::uint32_t tunnels = 0;  // genus, summed over the pieces
};

/// mesh: an oriented manifold without isolated vertices. Cost: O(F).
[[nodiscard]] MeshTopology topologyOf(const TriangleMesh& mesh);

/// Why a base mesh has more faces than were asked for, for people; empty when it has not.
[[nodiscard]] std::string
whyBaseIsLarger(std::uint32_t faces, std::uint32_t asked, const MeshTopology& topology);

}  // namespace limn
