// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/forest/collapse_cost.h"

#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/split_forest.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

struct ForestOptions {
  std::uint32_t baseFaces = 800;  // stop at this many faces, or where no collapse is left
  CollapseCost cost = CollapseCost::kMemoryless;  // README.md has the comparison
  Placement placement = Placement::kSubset;       // … and of this
  double creaseAngleDegrees = 40.0;               // edges whose faces differ by more are creases
  unsigned threads = 2;                           // the result does not depend on it
};

/// One level of detail: the mesh of all vertices up to this level.
struct LevelSummary {
  std::uint32_t vertices = 0;
  std::uint32_t faces = 0;
  double rmsError =
      0.0;  // distance from the full mesh's vertices, grid units (a close upper bound)
};

struct BuiltForest {
  SplitForest forest;
  std::vector<std::uint8_t> baseDraco;   // the base mesh, its points in vertex id order
  std::uint64_t baseAttributeBytes = 0;  // of baseDraco: colours and normals
  std::vector<LevelSummary> levels;      // coarse to fine; level 0 is the base mesh
};

/// Simplifies `mesh` by half-edge collapses in independent-set levels and records them as a forest
/// of vertex splits. seams: kFeatureSeam or 0 a half-edge (3 · triangle + corner), equal on twins;
/// or empty. Deterministic for any number of threads. Errors: kNonManifold.
/// Cost: about 4 times the mesh's size in vertex visits; 60 bytes a vertex besides the result.
[[nodiscard]] Result<BuiltForest> buildForest(
    const TriangleMesh& mesh,
    const ForestOptions& options,
    std::span<const std::uint8_t> seams = {});

}  // namespace limn
