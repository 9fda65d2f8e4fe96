// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/cone_tree.h"
#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// What ConesDetector searches: cone trees that have every edge (kEdges) or face (kSmooth) of one
/// mesh state between them, each once. Can be carried over to another state of the mesh: what
/// changed leaves its leaf and goes into a new, smaller tree, which takes up the trees that are no
/// larger (so there are at most log₂ of the items). Cones are never changed: a leaf that lost items
/// is culled less often than it might be, never more. Copyable. Threads: const methods reentrant.
class ConeForest {
 public:
  /// One tree. tangentScale: DetectorOptions::coneTangentScale. Cost: O(items log items), some
  /// 0.4 µs an item.
  explicit ConeForest(const SilhouetteField& field, double tangentScale = 1.0);

  /// From the mesh `before`, which it was built for or last refitted to, to that of `after`.
  /// Positions by vertex, grid units. Cost: some ns a face, and 0.4 µs for every item near a
  /// change.
  void refit(
      const HalfEdgeMesh& before,
      std::span<const glm::ivec3> positionsBefore,
      const SilhouetteField& after);

  /// Leaves beside those that as many items need when built at once; 1 when new. A search costs
  /// about as much more.
  [[nodiscard]] double looseness() const;

  [[nodiscard]] SilhouetteKind kind() const { return kind_; }

  [[nodiscard]] std::span<const silhouette::ConeTree> trees() const { return trees_; }

  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  SilhouetteKind kind_;
  double tangentScale_;
  double leavesPerItem_ = 0.0;               // of the first tree when it was new
  std::vector<silhouette::ConeTree> trees_;  // the largest first
};

}  // namespace limn
