// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/result.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// An oriented manifold triangle mesh, with or without borders, as directed edges
/// [Campagna98, "Directed Edges"]: half-edge 3f + k belongs to face f, so `next`, `prev` and `face`
/// are arithmetic, and `origins` is an index buffer that a GPU draws as it is.
///
/// Invariants, checked by validate():
///  (1) The three origins of a face differ; every origin is < vertexCount().
///  (2) twins[twins[h]] = h, origin(twins[h]) = target(h); twins[h] = kNone on a border.
///  (3) Each directed edge (origin, target) occurs once.
///  (4) The faces around a vertex form one fan: rotating counter-clockwise from outgoing[v] visits
///      each half-edge out of v once.
///  (5) outgoing[v] has origin v; for a border vertex it is the half-edge without a twin.
///      outgoing[v] = kNone for a vertex without faces.
struct HalfEdgeMesh {
  std::vector<std::uint32_t> origins;  // 3 a face: slot the half-edge leaves from
  std::vector<HalfEdgeId> twins;       // 3 a face: the opposite half-edge or kNone
  std::vector<HalfEdgeId> outgoing;    // 1 a vertex

  [[nodiscard]] std::uint32_t vertexCount() const {
    return static_cast<std::uint32_t>(outgoing.size());
  }

  [[nodiscard]] std::uint32_t faceCount() const {
    return static_cast<std::uint32_t>(origins.size() / 3);
  }

  [[nodiscard]] static HalfEdgeId next(HalfEdgeId h) { return h % 3 == 2 ? h - 2 : h + 1; }

  [[nodiscard]] static HalfEdgeId prev(HalfEdgeId h) { return h % 3 == 0 ? h + 2 : h - 1; }

  [[nodiscard]] static FaceId face(HalfEdgeId h) { return h / 3; }

  [[nodiscard]] std::uint32_t origin(HalfEdgeId h) const { return origins[h]; }

  [[nodiscard]] std::uint32_t target(HalfEdgeId h) const { return origins[next(h)]; }

  [[nodiscard]] HalfEdgeId twin(HalfEdgeId h) const { return twins[h]; }

  /// The next half-edge out of the same vertex, counter-clockwise; kNone past a border.
  [[nodiscard]] HalfEdgeId rotateCcw(HalfEdgeId h) const { return twins[prev(h)]; }

  /// The same, clockwise; kNone past a border.
  [[nodiscard]] HalfEdgeId rotateCw(HalfEdgeId h) const {
    return twins[h] == kNone ? kNone : next(twins[h]);
  }

  [[nodiscard]] bool isBorderVertex(std::uint32_t v) const {
    return outgoing[v] != kNone && twins[outgoing[v]] == kNone;
  }

  /// The half-edge from a to b, or kNone. Cost: O(valence of a).
  [[nodiscard]] HalfEdgeId find(std::uint32_t a, std::uint32_t b) const;

  /// Neighbours of v counter-clockwise, from target(outgoing[v]); a border vertex's ring is the
  /// path from border to border. Cost: O(valence).
  void ring(std::uint32_t v, std::vector<std::uint32_t>& out) const;

  /// The triangles as index triples.
  [[nodiscard]] std::span<const glm::uvec3> triangles() const;

  /// Links triangles. Errors: kNonManifold (an edge with more than two faces or two of the same
  /// direction, a vertex with more than one fan, a repeated corner, an index ≥ vertexCount).
  /// Cost: O(faces · log valence). Threads: reentrant.
  [[nodiscard]] static Result<HalfEdgeMesh> build(
      std::uint32_t vertexCount,
      std::span<const glm::uvec3> triangles);
};

/// Checks every invariant; names the first one broken. For tests and after loading. O(faces).
[[nodiscard]] Result<void> validate(const HalfEdgeMesh& mesh);

}  // namespace limn
