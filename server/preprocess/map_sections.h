// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/hull_sections.h"
#include "server/preprocess/maps/hull_maps.h"

#include "protocol/messages.h"

#include "shared/mesh/triangle_mesh.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace limn {

/// The wire sections of an asset's maps, framed messages for channel 0, and what ModelInfo says.
/// All empty: no map, since there is no hull.
struct MapSections {
  std::vector<std::uint8_t> normals;
  std::vector<std::uint8_t> colors;  // empty: the mesh has none
  std::optional<protocol::MapInfo> info;
};

/// Shoots and codes the maps of `mesh` (as streamed) over the outer hull's level of at most `faces`
/// faces, as a client decodes it. Cost: about 1 µs a texel.
[[nodiscard]] MapSections encodeMapSections(
    const TriangleMesh& mesh,
    const HullSections& hulls,
    std::uint32_t faces,
    const MapOptions& options);

}  // namespace limn
