// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/progressive/active_mesh.h"
#include "shared/progressive/split_forest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace limn {

/// Everything about a client's mesh but the numbering of its slots and faces: equal meshes are
/// equal.
struct CanonicalMesh {
  std::map<VertexId, std::array<int, 3>> positions;
  std::map<VertexId, std::array<int, 5>> attributes;  // colour, normal
  std::map<VertexId, VertexId> parents;
  std::vector<std::array<VertexId, 3>> faces;                      // smallest corner first, sorted
  std::map<std::pair<VertexId, VertexId>, std::uint8_t> features;  // by directed edge
  friend bool operator==(const CanonicalMesh&, const CanonicalMesh&) = default;
};

/// Faces as sorted rotations of their permanent ids: equal meshes have equal lists.
inline std::vector<std::array<VertexId, 3>> canonicalFaces(
    std::span<const glm::uvec3> triangles,
    std::span<const VertexId> ids) {
  std::vector<std::array<VertexId, 3>> faces;
  for (const glm::uvec3& t : triangles) {
    std::array<VertexId, 3> face{ids[t.x], ids[t.y], ids[t.z]};
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

inline CanonicalMesh canonicalOf(const ActiveMesh& active) {
  CanonicalMesh canonical;
  const auto ids = active.ids();
  for (Slot s = 0; s < ids.size(); ++s) {
    const glm::ivec3 p = active.positions()[s];
    canonical.positions[ids[s]] = {p.x, p.y, p.z};
    const auto& [color, normal] = active.attributes().at(s);
    canonical.attributes[ids[s]] = {color.x, color.y, color.z, normal.x, normal.y};
    canonical.parents[ids[s]] = active.parentOf(ids[s]);
    EXPECT_EQ(active.slotOf(ids[s]), s);
  }
  const HalfEdgeMesh& mesh = active.mesh();
  canonical.faces = canonicalFaces(mesh.triangles(), ids);
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h)
    canonical.features[{ids[mesh.origin(h)], ids[mesh.target(h)]}] = active.features()[h];
  return canonical;
}

inline ActiveMesh baseMeshOf(const SplitForest& forest) {
  auto active = ActiveMesh::fromBase(forest.levelBegin, forest.baseMesh(), forest.baseFeatures);
  EXPECT_TRUE(active) << active.error().message;
  return active ? std::move(*active) : ActiveMesh();
}

}  // namespace limn
