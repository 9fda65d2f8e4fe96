// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/mesh/half_edge.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/slot_table.h"
#include "shared/progressive/vertex_split.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// A client's mesh: the base mesh and the splits applied so far, in any legal order, and not undone
/// since. Vertices sit in slots, the base's first and in order; permanent ids name them to the
/// outside. Positions are those of what is held: a split may move its parent. Always an oriented
/// manifold. Copyable: a copy is a snapshot. Memory follows what is held, not what levelBegin
/// announces.
class ActiveMesh {
 public:
  ActiveMesh() = default;

  /// levelBegin: first vertex of each level and, last, the number of vertices (ModelInfo).
  /// base: levelBegin[1] vertices; vertex i is id i; splits bring the attributes that it has.
  /// features: 1 a half-edge, or empty. Errors: kNonManifold, kCorrupt (counts disagree).
  [[nodiscard]] static Result<ActiveMesh> fromBase(
      std::vector<std::uint32_t> levelBegin,
      const TriangleMesh& base,
      std::span<const std::uint8_t> features);

  /// Applies one vertex split, the inverse of an edge collapse [Hoppe96].
  /// Gains 1 vertex and 1 (border) or 2 faces. Errors: kCorrupt (an id that is out of range,
  /// missing or already held, a parent that moves out of order or off the grid), kNonManifold (left
  /// and right do not bound a fan); the mesh is then unchanged. Cost: O(valence). Threads: one
  /// writer.
  [[nodiscard]] Result<void> apply(const VertexSplit& split);

  /// Takes the memory for so many splits (of a closed mesh) in all. May throw std::bad_alloc.
  void reserve(std::uint32_t splits);

  /// Undoes a split: afterwards the mesh is what it would be had that split never been applied, but
  /// for the numbering of slots and faces (the last ones move into the holes). Returns the split;
  /// applying it again brings the mesh back. Legal when no split that is held has `vertex` as a
  /// prerequisite; descending order of ids always is. What can be seen of that here is checked:
  /// errors kCorrupt (not a split that is held, a finer vertex is next to it or has moved it or its
  /// parent), kNonManifold (its collapse would break the mesh); the mesh is then unchanged. Cost:
  /// O(valence²).
  [[nodiscard]] Result<VertexSplit> undo(VertexId vertex);

  /// The ring of `parent` as it is in the mesh of all vertices coarser than `level` (ids,
  /// counter-clockwise; a path on a border): what cuts of level-`level` splits count in. Recovered
  /// from the current ring by replacing each vertex of this level or finer by its parent and
  /// dropping repeats. Errors: kCorrupt when `parent` is not held. Cost: O(valence).
  [[nodiscard]] Result<void>
  canonicalRing(VertexId parent, std::uint32_t level, std::vector<VertexId>& ring) const;

  /// The same by slots, for a parent that is held, as u.
  void canonicalRingSlots(Slot u, std::uint32_t level, std::vector<Slot>& ring) const;

  [[nodiscard]] bool holds(VertexId v) const { return slots_[v] != kNone; }

  [[nodiscard]] Slot slotOf(VertexId v) const { return slots_[v]; }  // kNone when not held

  [[nodiscard]] VertexId parentOf(VertexId v) const { return parents_[slots_[v]]; }

  [[nodiscard]] std::uint32_t levelOf(VertexId v) const { return limn::levelOf(levelBegin_, v); }

  [[nodiscard]] const HalfEdgeMesh& mesh() const { return mesh_; }  // by slot

  [[nodiscard]] std::span<const glm::ivec3> positions() const {
    return positions_;
  }  // by slot, grid

  /// Whether any split that was applied has moved its parent.
  [[nodiscard]] bool hasMoves() const { return !moves_.empty(); }

  /// Where a vertex stands in the mesh of the vertices before `end`, above its own id: what
  /// predictions of splits of the level that begins there count from. Cost: O(its moves since).
  [[nodiscard]] glm::ivec3 positionIn(VertexId end, Slot slot) const {
    glm::ivec3 position = positions_[slot];
    if (moves_.empty()) return position;
    for (VertexId w = lastMoves_[slot]; w != kNone && w >= end; w = moves_[slots_[w]].earlier)
      position -= moves_[slots_[w]].by;
    return position;
  }

  [[nodiscard]] std::span<const VertexId> ids() const { return ids_; }  // by slot

  [[nodiscard]] std::span<const std::uint8_t> features() const {
    return features_;
  }  // by half-edge

  [[nodiscard]] std::span<const std::uint32_t> levelBegin() const { return levelBegin_; }

  [[nodiscard]] std::uint32_t splitsHeld() const {
    return static_cast<std::uint32_t>(ids_.size()) - baseVertexCount();
  }

  [[nodiscard]] std::uint32_t baseVertexCount() const {
    return levelBegin_.size() < 2 ? 0 : levelBegin_[1];
  }

  [[nodiscard]] const AttributeArrays& attributes() const { return attributes_; }  // by slot

  /// Memory held.
  [[nodiscard]] std::size_t bytes() const;

  [[nodiscard]] std::uint32_t splitsTotal() const {
    return levelBegin_.empty() ? 0 : levelBegin_.back() - baseVertexCount();
  }

 private:
  /// Where a split opens: the half-edges of u's current ring that the new faces attach to.
  struct Opening {
    HalfEdgeId beforeLeft = kNone;  // l → u of the face (or border edge) before the fan
    HalfEdgeId afterRight = kNone;  // u → r of the face (or border edge) after the fan
  };

  static tl::unexpected<Error> corrupt(VertexId vertex, const char* what);
  /// Also fills fan_.
  [[nodiscard]] Result<Opening> findOpening(const VertexSplit& split);
  /// Moves the parent, in slot u, of a split that was just applied, and keeps its history.
  void moveParent(const VertexSplit& split, Slot u);
  /// Gives a half-edge the features that `split` has for the edge `bit`.
  void setFeature(HalfEdgeId h, const VertexSplit& split, SplitFeature bit);

  /// What a collapse of a vertex into its parent takes away; the reverse of an Opening.
  struct Star {
    Slot u = kNone;
    HalfEdgeId toParent = kNone;    // v → u, in the left face; kNone: there is none
    HalfEdgeId fromParent = kNone;  // u → v, in the right face; kNone: there is none
    std::vector<HalfEdgeId> fan;    // half-edges out of v of the faces that stay
  };

  /// What a split did to its parent's position. A vertex that moves keeps its history as a chain
  /// through those of its children that moved it, finest first.
  struct ParentMove {
    glm::ivec3 by{0};          // zero: the parent stayed where it was
    VertexId earlier = kNone;  // the child that moved it before
  };

  [[nodiscard]] Result<Star> findStar(VertexId vertex) const;

  /// Makes twins of two half-edges of one edge; kNone: there is no face on that side.
  void link(HalfEdgeId a, HalfEdgeId b) {
    if (a != kNone) mesh_.twins[a] = b;
    if (b != kNone) mesh_.twins[b] = a;
  }

  /// Finds outgoing[slot] anew, starting at any half-edge out of it.
  void resetOutgoing(Slot slot, HalfEdgeId any);
  void removeFace(FaceId face);
  void removeVertex(Slot slot);

  std::vector<std::uint32_t> levelBegin_;
  HalfEdgeMesh mesh_;
  std::vector<glm::ivec3> positions_;
  std::vector<VertexId> ids_;
  std::vector<VertexId> parents_;  // by slot: id of the parent; kNone for base vertices
  std::vector<std::uint8_t> features_;
  std::vector<std::uint8_t> replaced_;  // by slot: features of u–l and, << 2, u–r before the split
  AttributeArrays attributes_;          // by slot
  // By slot, from the first split that moves its parent on; before, nothing has a history.
  std::vector<ParentMove> moves_;    // of the split that brought the vertex
  std::vector<VertexId> lastMoves_;  // the finest split that moved the vertex; kNone
  SlotTable slots_;
  std::vector<HalfEdgeId> fan_;  // scratch: half-edges out of u whose faces move to v, ccw
};

}  // namespace limn
