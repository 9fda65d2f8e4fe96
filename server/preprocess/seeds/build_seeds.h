// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/silhouette/seed_table.h"

#include <cstdint>
#include <span>

namespace limn {

struct SeedOptions {
  int azimuths = 8;                // viewpoints round the y axis
  int elevations = 5;              // and rings of them, evenly between the poles
  double distanceRadii = 3.0;      // of a viewpoint from the model's centre
  int imageSize = 384;             // pixels a side of the pictures that visibility is read from
  std::uint32_t seedsPerLoop = 3;  // of a long loop; short ones get fewer
  std::uint32_t seedsPerView = 96;
  /// Viewpoints added where the contours change fast, at most this share of the grid's; of a mesh
  /// with more than 100,000 faces, for which each takes longer, in proportion fewer.
  double extraViewpoints = 0.5;
};

/// Computes where silhouette loops can be picked up, for a grid of viewpoints. Of each viewpoint
/// every loop of both kinds is traced on the full mesh; loops are ranked by the length that is
/// seen, measured in a face-id image and confirmed by its Canny edges, hidden ones by their
/// segments; a loop's seeds lie on what is seen of it. Between the grid's viewpoints others are
/// added where seeds of the nearest ones lead to least. mesh: an oriented manifold, vertices by
/// permanent id. parents: one a vertex split (SplitForest). Deterministic. Threads: reentrant;
/// makes its own GL context. Cost, 40 views: some 10 µs a face. Errors: kUnavailable without a
/// working OSMesa, kNonManifold, kInvalidArgument (no viewpoints, sizes that disagree).
[[nodiscard]] Result<SeedTable> buildSeeds(
    const TriangleMesh& mesh,
    std::span<const VertexId> parents,
    std::uint32_t baseVertexCount,
    const SeedOptions& options = {});

}  // namespace limn
