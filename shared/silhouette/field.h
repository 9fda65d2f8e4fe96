// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Which curve is the silhouette.
enum class SilhouetteKind : std::uint8_t {
  kEdges,   // mesh edges between a front face and a back face
  kSmooth,  // zero set of the interpolated normal · view across faces [HertzmannZorin00]
};

/// Where a silhouette is seen from, in grid units of the mesh: perspective from `eye`, or
/// orthographic along `forward` (unit; `eye` is then ignored).
struct SilhouetteView {
  glm::dvec3 eye{0.0};
  glm::dvec3 forward{0.0, 0.0, -1.0};
  bool orthographic = false;
};

/// A vertex of a smooth field: what following its silhouette takes of it, in half a cache line.
struct alignas(32) VertexSite {
  glm::vec4 plane{0.0F};
  glm::vec4 position{0.0F};  // x, y, z: grid units, exact; w: 0
};

/// A mesh as a silhouette problem: one oriented plane for each face (kEdges) or vertex (kSmooth),
/// and the one float predicate that every detector and the chaining share. A *site* is a face or a
/// vertex, by kind; a site is *front* where its plane's value at the eye is > 0.
///
/// Refers to `mesh` and `positions`, which must outlive it unchanged. Constant after construction;
/// safe to read from any thread.
class SilhouetteField {
 public:
  /// positions: one a vertex of `mesh`, grid units. Cost: O(faces). Threads: reentrant.
  SilhouetteField(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      SilhouetteKind kind);

  /// The eye in homogeneous coordinates about center(): (eye − center, 1), or (−forward, 0).
  [[nodiscard]] glm::vec4 eyeOf(const SilhouetteView& view) const;

  /// Value of a plane: > 0 in front. The order of operations is part of the contract: vectorised
  /// detectors use the same one, without contraction, so that all agree to the last bit.
  [[nodiscard]] static float valueAt(const glm::vec4& plane, const glm::vec4& eye) {
    return ((plane.x * eye.x + plane.y * eye.y) + plane.z * eye.z) + plane.w * eye.w;
  }

  [[nodiscard]] float value(std::uint32_t site, const glm::vec4& eye) const {
    return valueAt(plane(site), eye);
  }

  [[nodiscard]] bool isFront(std::uint32_t site, const glm::vec4& eye) const {
    return value(site, eye) > 0.0F;
  }

  [[nodiscard]] SilhouetteKind kind() const { return kind_; }

  [[nodiscard]] const HalfEdgeMesh& mesh() const { return *mesh_; }

  [[nodiscard]] std::span<const glm::ivec3> positions() const { return positions_; }

  /// Faces: twice the area times the unit normal; vertices: the unit angle-weighted mean of the
  /// normals around. w: offset about center(). A site without area has plane 0: back.
  [[nodiscard]] const glm::vec4& plane(std::uint32_t site) const {
    return kind_ == SilhouetteKind::kEdges ? facePlanes_[site] : vertices_[site].plane;
  }

  [[nodiscard]] std::uint32_t siteCount() const {
    return static_cast<std::uint32_t>(facePlanes_.size() + vertices_.size());
  }

  /// kSmooth: all sites. kEdges: none.
  [[nodiscard]] std::span<const VertexSite> vertices() const { return vertices_; }

  /// Memory held, the mesh's and positions' excluded.
  [[nodiscard]] std::size_t memoryBytes() const {
    return facePlanes_.size() * sizeof(glm::vec4) + vertices_.size() * sizeof(VertexSite);
  }

  /// Whether any edge of the mesh has one face only.
  [[nodiscard]] bool hasBorder() const { return hasBorder_; }

  /// Centre of the box of the positions, rounded to the grid; floats are relative to it.
  [[nodiscard]] const glm::ivec3& center() const { return center_; }

 private:
  const HalfEdgeMesh* mesh_;
  std::span<const glm::ivec3> positions_;
  SilhouetteKind kind_;
  glm::ivec3 center_{0};
  bool hasBorder_ = false;
  // By kind, one of the two.
  std::vector<glm::vec4> facePlanes_;
  std::vector<VertexSite> vertices_;
};

}  // namespace limn
