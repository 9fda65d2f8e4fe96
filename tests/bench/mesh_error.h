// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/bench/plain_mesh.h"

#include <cstdint>

namespace limn::bench {

/// How far two surfaces are apart, both ways together, in the meshes' units.
struct SurfaceError {
  double mean = 0.0;
  double rms = 0.0;
  double max = 0.0;
};

/// Distances from random points of each surface (uniform by area) and from its vertices to the
/// other one. samples: points a surface. Mean and rms are over the random points of both, the
/// maximum over all of them and the vertices. Deterministic. Cost: some 5 µs a point.
[[nodiscard]] SurfaceError
surfaceError(const PlainMesh& one, const PlainMesh& other, std::uint32_t samples);

/// Signed volume, by the divergence theorem; of a mesh with borders, that of the cone over it.
[[nodiscard]] double volume(const PlainMesh& mesh);

/// Length of the diagonal of the bounding box of the used vertices.
[[nodiscard]] double diagonal(const PlainMesh& mesh);

}  // namespace limn::bench
