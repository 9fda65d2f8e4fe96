// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/property/legal_order.h"
#include "tests/property/shared/silhouette/views.h"

#include "shared/progressive/active_mesh.h"
#include "shared/silhouette/cone_forest.h"
#include "shared/silhouette/detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace limn::testing {

inline std::vector<std::uint32_t> sorted(const SilhouetteResult& result) {
  std::vector<std::uint32_t> found =
      result.kind == SilhouetteKind::kEdges ? result.edges : result.faces;
  std::sort(found.begin(), found.end());
  return found;
}

/// A mesh that is refined and coarsened at random.
class Wanderer {
 public:
  Wanderer(const SplitForest& forest, std::uint64_t seed) : forest_(&forest), rng_(seed) {
    mesh_ = *ActiveMesh::fromBase(forest.levelBegin, forest.baseMesh(), forest.baseFeatures);
    order_ = randomLegalOrder(forest, rng_, OrderKind::kDepthFirst);
  }

  /// Up to `most` splits applied or undone, the latter in the opposite order.
  void step(std::uint32_t most) {
    std::uint32_t count = 1 + rng_.below(most);
    if (held_ == order_.size() || (held_ > 0 && rng_.below(3) == 0)) {
      for (; count > 0 && held_ > 0; --count)
        ASSERT_TRUE(mesh_.undo(order_[--held_]));
    } else {
      for (; count > 0 && held_ < order_.size(); --count)
        ASSERT_TRUE(mesh_.apply(forest_->split(order_[held_++])));
    }
  }

  [[nodiscard]] const ActiveMesh& mesh() const { return mesh_; }

  [[nodiscard]] std::uint32_t splits() const { return static_cast<std::uint32_t>(order_.size()); }

  [[nodiscard]] TriangleMesh shape() const {
    TriangleMesh shape{forest_->grid, {}, {}};
    shape.positions.assign(mesh_.positions().begin(), mesh_.positions().end());
    return shape;
  }

 private:
  const SplitForest* forest_;
  Rng rng_;
  ActiveMesh mesh_;
  std::vector<VertexId> order_;
  std::size_t held_ = 0;
};

/// Cones that are given find what brute force finds.
inline void expectComplete(
    const SilhouetteField& field,
    const std::shared_ptr<const ConeForest>& cones,
    const TriangleMesh& shape,
    int viewCount) {
  const auto brute = makeDetector(DetectorMethod::kBrute, field);
  DetectorOptions options;
  options.cones = cones;
  const auto found = makeDetector(DetectorMethod::kCones, field, options);
  const auto exact = makeDetector(DetectorMethod::kExact, field, options);
  for (const SilhouetteView& view : randomViews(shape, viewCount, 5)) {
    const auto truth = sorted(brute->detect(view));
    ASSERT_EQ(sorted(found->detect(view)), truth);
    ASSERT_EQ(sorted(exact->detect(view)), truth);
  }
}

}  // namespace limn::testing
