// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/mesh/half_edge.h"
#include "shared/mesh/triangle_mesh.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace limn {

/// A half-edge collapse v → u [Hoppe96]: u stays, where it stood or elsewhere. The sides are the
/// third corners of the one or two faces that vanish; kNone on a border.
struct HalfEdgeCollapse {
  std::uint32_t removed = kNone;  // v
  std::uint32_t kept = kNone;     // u
  std::uint32_t left = kNone;     // l: around u counter-clockwise come l, v, r
  std::uint32_t right = kNone;    // r
  glm::ivec3 position{0};         // of u afterwards
  std::uint8_t features = 0;      // SplitFeature bits of the creases before the collapse
  std::uint8_t seams = 0;         // and of the seams
  std::size_t ringSize = 0;       // neighbours of u after the collapse
};

/// A triangle mesh that is simplified by half-edge collapses. Vertex numbers are those of the
/// input; dead faces are compacted on demand.
class CollapseMesh {
 public:
  /// features: EdgeFeature bits, 1 a half-edge. Errors: kNonManifold.
  [[nodiscard]] static Result<CollapseMesh> build(
      const TriangleMesh& mesh,
      std::vector<std::uint8_t> features);

  /// The collapse v → u of the edge between them that leaves u at `position`, if it keeps the mesh
  /// a simple manifold: the link condition [Dey99, "Topology preserving edge contraction"], border
  /// rules, no face that turns by more than leastNormalCosine says. nullopt otherwise.
  /// Cost: O(valence of both).
  [[nodiscard]] std::optional<HalfEdgeCollapse> plan(
      std::uint32_t v,
      std::uint32_t u,
      const glm::ivec3& position,
      double leastNormalCosine) const;

  /// Carries out a collapse that plan() returned and nothing has touched since.
  void collapse(const HalfEdgeCollapse& collapse);

  /// Removes dead faces, so that the arrays shrink with the mesh.
  void compact();

  [[nodiscard]] const HalfEdgeMesh& mesh() const { return mesh_; }

  [[nodiscard]] const std::vector<glm::ivec3>& positions() const { return positions_; }

  [[nodiscard]] const std::vector<std::uint8_t>& features() const { return features_; }

  [[nodiscard]] std::uint32_t aliveFaces() const { return aliveFaces_; }

  /// A face that no collapse has removed.
  [[nodiscard]] bool isAlive(FaceId f) const { return mesh_.origins[3 * f] != kNone; }

  /// Calls visit(h, a, b) for each face (v, a, b) around v, counter-clockwise; h runs from v to a.
  template <class Visit>
  void forEachFace(std::uint32_t v, Visit visit) const {
    const HalfEdgeId first = mesh_.outgoing[v];
    for (HalfEdgeId h = first; h != kNone;) {
      visit(h, mesh_.target(h), mesh_.origin(HalfEdgeMesh::prev(h)));
      h = mesh_.rotateCcw(h);
      if (h == first) break;
    }
  }

  /// Twice the area times the unit normal, exact.
  [[nodiscard]] glm::dvec3 areaNormal(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  /// The same with another place for the first corner.
  [[nodiscard]] glm::dvec3 areaNormal(const glm::ivec3& at, std::uint32_t b, std::uint32_t c) const;

 private:
  /// Whether a face of v without u turns too far when v goes to `position`.
  [[nodiscard]] bool turnsFace(
      std::uint32_t v,
      std::uint32_t u,
      const glm::ivec3& position,
      double leastNormalCosine) const;
  HalfEdgeId removeFace(HalfEdgeId inner);
  void settleOutgoing(std::uint32_t v, HalfEdgeId any);

  HalfEdgeMesh mesh_;
  std::vector<glm::ivec3> positions_;
  std::vector<std::uint8_t> features_;
  std::uint32_t aliveFaces_ = 0;
};

}  // namespace limn
