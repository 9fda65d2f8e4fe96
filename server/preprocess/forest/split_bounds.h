// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/forest/collapse_mesh.h"

#include "shared/progressive/split_forest.h"
#include "shared/view/normal_cone.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// Gathers the view parameters of splits while their collapses are made: what of the full mesh
/// hangs below each vertex, how far the surface has moved there, which way it faces.
class BoundsGatherer {
 public:
  /// mesh: the full mesh, before any collapse. placement: of the collapses to come.
  BoundsGatherer(const CollapseMesh& mesh, Placement placement);

  /// Bounds of the split that undoes `collapse`; to be called just before it is carried out.
  /// Cost: O(valence).
  [[nodiscard]] SplitBounds beforeCollapse(
      const CollapseMesh& mesh,
      const HalfEdgeCollapse& collapse);

 private:
  // What hangs below a vertex that is still there.
  struct Subtree {
    float radius = 0.0F;     // around the vertex, grid units
    float deviation = 0.0F;  // of the current surface from the full one near the vertex
    NormalCone cone;
  };

  Placement placement_;
  std::vector<Subtree> subtrees_;
  std::vector<Subtree> stars_;  // of the full mesh's faces around each vertex, wherever it is now
};

}  // namespace limn
