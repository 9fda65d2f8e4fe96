// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/vertex_split.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// View parameters of one split, on the server only: what of the full mesh is missing while this
/// split is (it and everything that descends from it).
struct SplitBounds {
  glm::vec3 center{0.0F};  // grid units: sphere around every full-mesh face that is missing
  float radius = 0.0F;
  float error = 0.0F;  // grid units: bound of the distance to the full mesh while missing
  glm::vec3 coneAxis{0.0F, 0.0F, 1.0F};  // unit
  float coneCos = -1.0F;  // cosine of the half-angle that holds the faces' normals; −1: anything
};

/// Where parents stood before their splits, when collapses move the vertex that stays
/// (Placement::kVolume). A vertex is split once a level at most, so that its position at a level is
/// its last one less the moves of that level and finer ones (README.md). Empty: nothing ever moves.
struct ParentMoves {
  std::vector<glm::ivec3> by;  // by split: VertexSplit::parentMove

  // Derived (SplitForest::deriveMoves).
  std::vector<VertexId> last;              // by vertex: the finest split that moves it, kNone
  std::vector<VertexId> earlier;           // by split that moves its parent: the one before, kNone
  std::vector<std::uint32_t> neededBegin;  // splits + 1 offsets into `needed`
  std::vector<VertexId> needed;            // prerequisites besides parent and ring

  [[nodiscard]] std::size_t bytes() const {
    return by.capacity() * sizeof(by[0]) +
           sizeof(VertexId) *
               (last.capacity() + earlier.capacity() + neededBegin.capacity() + needed.capacity());
  }
};

/// The prepared progressive mesh [Hoppe96] as a forest of vertex splits in independent-set levels.
/// A split is named by the vertex it brings in; ids are permanent (see ids.h). Constant after
/// construction; safe to read from any thread.
struct SplitForest {
  Grid grid;
  std::vector<std::uint32_t> levelBegin;   // first vertex of each level, base = level 0, then V
  std::vector<glm::ivec3> positions;       // V, by vertex id, on the grid: of the full mesh
  std::vector<glm::uvec3> baseTriangles;   // among vertices 0 … baseVertexCount() − 1
  std::vector<std::uint8_t> baseFeatures;  // 1 a base half-edge, EdgeFeature bits
  std::vector<glm::uvec3> triangles;       // F, the full mesh

  // One a split, index id − baseVertexCount().
  std::vector<VertexId> parents;
  std::vector<std::uint32_t> ringBegin;  // splits + 1 offsets into `rings`
  std::vector<VertexId> rings;           // canonical rings: with the parent, prerequisites
  std::vector<RingCut> cuts;
  std::vector<std::uint8_t> features;  // SplitFeature bits
  std::vector<SplitBounds> bounds;

  std::vector<std::uint8_t> seams;  // SplitFeature bits; empty: the model has none
  AttributeArrays attributes;       // by vertex id
  ParentMoves moves;

  [[nodiscard]] Placement placement() const {
    return moves.by.empty() ? Placement::kSubset : Placement::kVolume;
  }

  /// What the model carries besides positions: AttributeKind bits.
  [[nodiscard]] std::uint8_t attributeKinds() const {
    return static_cast<std::uint8_t>(attributes.kinds() | (seams.empty() ? 0 : kAttributeSeams));
  }

  [[nodiscard]] std::uint32_t vertexCount() const { return levelBegin.back(); }

  [[nodiscard]] std::uint32_t baseVertexCount() const { return levelBegin[1]; }

  [[nodiscard]] std::uint32_t splitCount() const { return vertexCount() - baseVertexCount(); }

  [[nodiscard]] std::uint32_t levelCount() const {
    return static_cast<std::uint32_t>(levelBegin.size()) - 1;
  }

  [[nodiscard]] std::uint32_t levelOf(VertexId v) const { return limn::levelOf(levelBegin, v); }

  [[nodiscard]] VertexId parent(VertexId v) const { return parents[v - baseVertexCount()]; }

  /// Canonical ring of v's parent, counter-clockwise. With the parent: v's prerequisites where
  /// nothing moves.
  [[nodiscard]] std::span<const VertexId> ring(VertexId v) const {
    const std::uint32_t s = v - baseVertexCount();
    return {rings.data() + ringBegin[s], ringBegin[s + 1] - ringBegin[s]};
  }

  /// Calls visit(w) for each prerequisite of split v: its parent, the parent's canonical ring, and
  /// the splits that put those where they stand at v's level. Some may come twice.
  template <class Visit>
  void forEachPrerequisite(VertexId v, Visit visit) const {
    visit(parent(v));
    for (const VertexId w : ring(v))
      visit(w);
    if (moves.by.empty()) return;
    const std::uint32_t s = v - baseVertexCount();
    for (std::uint32_t i = moves.neededBegin[s]; i < moves.neededBegin[s + 1]; ++i)
      visit(moves.needed[i]);
  }

  /// Calls visit(v) for the splits that make a face of the full mesh be there as it is: its finest
  /// corner, which needs the others, and what moves its corners last.
  template <class Visit>
  void forEachSplitOfFace(const glm::uvec3& face, Visit visit) const {
    const VertexId finest = std::max({face.x, face.y, face.z});
    if (finest >= baseVertexCount()) visit(finest);
    if (moves.by.empty()) return;
    for (int k = 0; k < 3; ++k) {
      if (moves.last[face[k]] != kNone) visit(moves.last[face[k]]);
    }
  }

  /// Where v stands in the mesh of the vertices before `end`, which is above v: the first vertex of
  /// a level, or any other id. Cost: O(moves of v from there on).
  [[nodiscard]] glm::ivec3 positionIn(VertexId end, VertexId v) const {
    glm::ivec3 position = positions[v];
    if (moves.by.empty()) return position;
    for (VertexId w = moves.last[v]; w != kNone && w >= end;
         w = moves.earlier[w - baseVertexCount()])
      position -= moves.by[w - baseVertexCount()];
    return position;
  }

  /// The split as a client applies it.
  [[nodiscard]] VertexSplit split(VertexId v) const;

  /// The mesh that splits begin with.
  [[nodiscard]] TriangleMesh baseMesh() const;

  /// Fills the derived part of `moves`, when positions, levels, parents, rings and moves.by are
  /// there. Cost: O(splits · ring).
  void deriveMoves();
};

/// Flat bytes of a forest for the asset's "forest" section, and back. Errors: kCorrupt; every index
/// is checked. FORMAT.md has the layout.
[[nodiscard]] std::vector<std::uint8_t> serializeForest(const SplitForest& forest);
[[nodiscard]] Result<SplitForest> parseForest(std::span<const std::uint8_t> bytes);

}  // namespace limn
