// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/mesh/half_edge.h"
#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// No coordinate of a hull is larger in magnitude: hull grids are finer than those of meshes, and
/// outer hulls leave the model's box.
inline constexpr std::int32_t kMaxHullCoordinate = 1 << 22;

/// One vertex split of a progressive hull: the inverse of an edge collapse that moved the vertex
/// that it left. The new vertex is the mesh's next one.
struct HullSplit {
  std::uint32_t vertex = kNone;  // u: splits
  std::uint32_t left = kNone;   // l, r: neighbours of u. u's fan from l counter-clockwise to r goes
  std::uint32_t right = kNone;  // to the new vertex, and the faces (u, l, new), (new, r, u) open
  glm::ivec3 keptPosition{0};   // where u moves
  glm::ivec3 addedPosition{0};  // of the new vertex
};

/// A progressive hull [Sander00]: a closed base mesh and the splits that refine it, in order. After
/// any number of them the mesh encloses the original (an outer hull) or is enclosed by it (an inner
/// one). Positions are on `base.grid`, which is finer than the model's.
struct ProgressiveHull {
  TriangleMesh base;
  std::vector<HullSplit> splits;

  /// Faces after `count` splits.
  [[nodiscard]] std::uint32_t facesAfter(std::size_t count) const {
    return static_cast<std::uint32_t>(base.triangles.size() + 2 * count);
  }

  /// Splits that fit into `faces` faces.
  [[nodiscard]] std::size_t splitsFor(std::uint32_t faces) const;
};

/// A closed mesh that hull splits are applied to.
class HullRefiner {
 public:
  /// Errors: kNonManifold (also when not closed).
  [[nodiscard]] static Result<HullRefiner> fromBase(const TriangleMesh& base);

  /// Errors: kCorrupt (no such vertices or positions), kNonManifold; the mesh is then unchanged.
  /// Cost: O(valence).
  [[nodiscard]] Result<void> apply(const HullSplit& split);

  [[nodiscard]] const HalfEdgeMesh& links() const { return links_; }

  [[nodiscard]] const std::vector<glm::ivec3>& positions() const { return positions_; }

  [[nodiscard]] TriangleMesh mesh() const;

 private:
  Grid grid_;
  HalfEdgeMesh links_;
  std::vector<glm::ivec3> positions_;
};

/// The hull after its first `count` splits. Errors: as fromBase() and apply().
[[nodiscard]] Result<TriangleMesh> hullAfter(const ProgressiveHull& hull, std::size_t count);

/// Six times the signed volume in grid steps cubed, exact up to 2^53.
[[nodiscard]] double volume6(const TriangleMesh& mesh);

}  // namespace limn
