// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/result.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/vertex_split.h"

#include <glm/glm.hpp>

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

/// The prepared progressive mesh [Hoppe96] as a forest of vertex splits in independent-set levels.
/// A split is named by the vertex it brings in; ids are permanent (see ids.h). Constant after
/// construction; safe to read from any thread.
struct SplitForest {
  Grid grid;
  std::vector<std::uint32_t> levelBegin;   // first vertex of each level, base = level 0, then V
  std::vector<glm::ivec3> positions;       // V, by vertex id, on the grid
  std::vector<glm::uvec3> baseTriangles;   // among vertices 0 … baseVertexCount() − 1
  std::vector<std::uint8_t> baseFeatures;  // 1 a base half-edge, EdgeFeature bits
  std::vector<glm::uvec3> triangles;       // F, the full mesh

  // One a split, index id − baseVertexCount().
  std::vector<VertexId> parents;
  std::vector<std::uint32_t> ringBegin;  // splits + 1 offsets into `rings`
  std::vector<VertexId> rings;           // canonical rings: with the parent, the prerequisites
  std::vector<RingCut> cuts;
  std::vector<std::uint8_t> features;  // SplitFeature bits
  std::vector<SplitBounds> bounds;

  std::vector<std::uint8_t> seams;  // SplitFeature bits; empty: the model has none
  AttributeArrays attributes;       // by vertex id

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

  /// Canonical ring of v's parent, counter-clockwise. With the parent: v's prerequisites.
  [[nodiscard]] std::span<const VertexId> ring(VertexId v) const {
    const std::uint32_t s = v - baseVertexCount();
    return {rings.data() + ringBegin[s], ringBegin[s + 1] - ringBegin[s]};
  }

  /// The split as a client applies it.
  [[nodiscard]] VertexSplit split(VertexId v) const;
};

/// Flat bytes of a forest for the asset's "forest" section, and back. Errors: kCorrupt; every index
/// is checked. FORMAT.md has the layout.
[[nodiscard]] std::vector<std::uint8_t> serializeForest(const SplitForest& forest);
[[nodiscard]] Result<SplitForest> parseForest(std::span<const std::uint8_t> bytes);

}  // namespace limn
