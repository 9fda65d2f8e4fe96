// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/target_set.h"
#include "server/session/view.h"

#include "shared/core/result.h"
#include "shared/mesh/half_edge.h"
#include "shared/progressive/split_forest.h"
#include "shared/silhouette/field.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace limn {

/// Finds what a client must hold so that its silhouettes are those of the full mesh, edge for edge:
/// hidden ones included, no frustum test. Constant after construction; safe from any thread.
class ExactFinder {
 public:
  /// forest must outlive it. Errors: kNonManifold (the forest's triangles are no manifold).
  [[nodiscard]] static Result<std::unique_ptr<const ExactFinder>> make(const SplitForest& forest);

  /// Faces of the full mesh that must be there as they are: on kEdges both faces of every
  /// silhouette edge; on kSmooth all faces around the corners of every face that the silhouette
  /// crosses. One byte a face. Cost: O(faces), brute force: about 5 ns each.
  [[nodiscard]] std::vector<std::uint8_t> neededFaces(const View& view) const;

  /// The splits that make those faces present, closed, as a set of one class: coarse first. A face
  /// of the full mesh is present when the finest of its corners is.
  [[nodiscard]] TargetSet select(const View& view) const;

  [[nodiscard]] std::size_t bytes() const;

 private:
  ExactFinder(const SplitForest& forest, HalfEdgeMesh mesh);

  const SplitForest& forest_;
  HalfEdgeMesh mesh_;  // the full mesh by vertex id
  SilhouetteField edges_;
  SilhouetteField smooth_;
};

}  // namespace limn
