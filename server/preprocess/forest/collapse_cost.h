// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/forest/collapse_mesh.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
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

/// A quadratic form q(d) of a displacement.
struct Form {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  /// Adds weight · (direction · d)².
  void add(const glm::dvec3& direction, double weight);
  [[nodiscard]] double at(const glm::dvec3& d) const;

  [[nodiscard]] double trace() const { return xx + yy + zz; }

  /// The form's matrix times d: half its gradient.
  [[nodiscard]] glm::dvec3 times(const glm::dvec3& d) const;
};

/// What the costs of all collapses out of one vertex have in common.
struct VertexCost {
  std::uint32_t vertex = kNone;
  std::uint32_t degree = 0;
  Form surface;           // of the displacement of the vertex; not for kQuadric
  Form lines;             // … what borders and creases add; kVolume only
  bool isOnLine = false;  // a border, crease or seam passes
  double weight = 0.0;    // the view sphere's: the share of view directions from which a silhouette
                          // crosses the vertex's faces, and a little, so that flat regions cost too
};

/// A collapse that moves the vertex that stays.
struct PlacedCollapse {
  glm::ivec3 position{0};
  double cost = 0.0;  // comparable with those of other collapses
};

/// Costs of half-edge collapses on one mesh. Holds what accumulates from collapse to collapse.
class CostModel {
 public:
  CostModel(CollapseCost kind, const CollapseMesh& mesh);

  /// Pure. Cost: O(valence), some 0.3 µs.
  [[nodiscard]] VertexCost around(const CollapseMesh& mesh, std::uint32_t v) const;

  /// Cost of v → u, comparable between all edges of the mesh; u must be a neighbour of v, and
  /// nothing must have changed since around(v). Pure. Cost: O(1), for kVolume O(valence of u).
  [[nodiscard]] double cost(const CollapseMesh& mesh, const VertexCost& v, std::uint32_t u) const;

  /// Where Placement::kVolume leaves u when v collapses into it: of the grid positions beside the
  /// place of least cost in the plane that keeps the volume, the best. What that is in flat
  /// directions is decided by a pull towards where u stood. nullopt: it stays there, since a
  /// border, crease or seam passes u or v, no plane keeps the volume, or the place is a single step
  /// away, farther off than the edge is long or out of the mesh's box. v, u: around() both. Pure.
  /// Cost: O(valence).
  [[nodiscard]] std::optional<PlacedCollapse>
  place(const CollapseMesh& mesh, const VertexCost& v, const VertexCost& u) const;

  /// around() without the view sphere's weight.
  [[nodiscard]] VertexCost formsAround(const CollapseMesh& mesh, std::uint32_t v) const;

  /// To be told of each collapse that is carried out.
  void collapsed(const HalfEdgeCollapse& collapse);

 private:
  /// Calls visit(areaNormal) for each face around v.
  template <class Visit>
  [[nodiscard]] VertexCost gather(const CollapseMesh& mesh, std::uint32_t v, Visit visit) const;

  CollapseCost kind_;
  glm::ivec3 low_{0};  // the mesh's box
  glm::ivec3 high_{0};
  std::vector<Quadric> quadrics_;  // by vertex; empty but for kQuadric
};

}  // namespace limn
