// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/map_layout.h"

#include <cstdint>
#include <vector>

namespace limn {

struct MapOptions {
  int texelsPerFace = 256;  // about; 128 to 512 in papers/003
  double creaseAngleDegrees = 40.0;
  unsigned threads = 0;  // 0: as many as there are cores; the result is the same
};

/// A mesh's normals and colours as images over a coarse hull of it, width · height texels, top row
/// first.
struct HullMaps {
  MapLayout layout;
  std::vector<std::uint8_t> normals;  // encodeMapNormal's two
  std::vector<std::uint8_t> colors;   // sRGB, three of 0 to kMapColorSteps; empty: none
  std::uint64_t misses = 0;           // texels of faces whose ray met nothing: the closest point's
};

/// Normal shooting [Sander00 §4]: from each texel's place on `hull`, against the interpolated
/// normal of the hull, to where that meets `mesh`; the mesh's interpolated normal and colour there.
/// mesh and hull may be on different grids with one origin. Cost: about 1 µs a texel.
[[nodiscard]] HullMaps
shootMaps(const TriangleMesh& mesh, const TriangleMesh& hull, const MapOptions& options);

}  // namespace limn
