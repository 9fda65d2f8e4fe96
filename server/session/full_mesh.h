// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/mesh/half_edge.h"
#include "shared/progressive/split_forest.h"
#include "shared/silhouette/field.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace limn {

/// The full mesh of a forest, linked, as a silhouette problem: what silhouettes of clients are
/// compared with. Constant after construction; safe from any thread.
class FullMesh {
 public:
  /// forest must outlive it. Errors: kNonManifold (the forest's triangles are no manifold).
  /// Cost: O(faces), about 0.3 µs each.
  [[nodiscard]] static Result<std::unique_ptr<const FullMesh>> make(const SplitForest& forest);

  [[nodiscard]] const SplitForest& forest() const { return forest_; }

  [[nodiscard]] const HalfEdgeMesh& mesh() const { return mesh_; }  // by vertex id

  [[nodiscard]] const SilhouetteField& field(SilhouetteKind kind) const {
    return kind == SilhouetteKind::kSmooth ? smooth_ : edges_;
  }

  /// The splits whose parent is `parent`, coarse to fine. Those a client holds come first.
  [[nodiscard]] std::span<const VertexId> childrenOf(VertexId parent) const {
    return {
        children_.data() + childrenBegin_[parent],
        childrenBegin_[parent + 1] - childrenBegin_[parent]};
  }

  [[nodiscard]] std::size_t bytes() const;

 private:
  FullMesh(const SplitForest& forest, HalfEdgeMesh mesh);

  const SplitForest& forest_;
  HalfEdgeMesh mesh_;
  SilhouetteField edges_;
  SilhouetteField smooth_;
  std::vector<std::uint32_t> childrenBegin_;  // vertices + 1 offsets into children_
  std::vector<VertexId> children_;
};

}  // namespace limn
