// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/collapse_mesh.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// Which edges collapse first (--cost).
enum class CollapseCost : std::uint8_t {
  kVolume,      // papers/002: volume, boundary, squared length and degree sum with λ = ½
  kQuadric,     // accumulated quadrics [GarlandHeckbert97], area-weighted
  kMemoryless,  // quadrics of the current mesh only [Lindstrom98]
};

/// A symmetric 4×4 form q(p) = pᵀAp + 2bᵀp + c: weighted sum of squared distances to planes.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  double x = 0, y = 0, z = 0;
  double c = 0;

  /// Adds weight · (distance to the plane through `point` with unit `normal`)².
  void addPlane(const glm::dvec3& normal, const glm::dvec3& point, double weight);
  Quadric& operator+=(const Quadric& other);
  [[nodiscard]] double at(const glm::dvec3& p) const;
};

/// Costs of half-edge collapses on one mesh. Holds what accumulates from collapse to collapse.
class CostModel {
 public:
  CostModel(CollapseCost kind, const CollapseMesh& mesh);

  /// Cost of v → u, comparable between the edges out of v; u must be a neighbour of v. Times
  /// silhouetteWeight(v): comparable between all edges of the mesh. Pure. Cost: O(1) for quadrics,
  /// O(valence) else.
  [[nodiscard]] double cost(const CollapseMesh& mesh, std::uint32_t v, std::uint32_t u) const;

  /// To be told of each collapse that is carried out.
  void collapsed(const HalfEdgeCollapse& collapse);

 private:
  CollapseCost kind_;
  std::vector<Quadric> quadrics_;  // by vertex; empty but for kQuadric
};

/// What the view sphere of papers/002 makes of a removal of v: the share of view directions from
/// which a silhouette crosses v's faces, and a little more, so that flat regions cost something.
/// Pure. Cost: O(valence), some 100 ns.
[[nodiscard]] double silhouetteWeight(const CollapseMesh& mesh, std::uint32_t v);

}  // namespace limn
