// SPDX-License-Identifier: Apache-2.0
// Based on: OGLdev tutorial 39, "Silhouette Detection" (positions merged before edges are matched).
// Deviation: the mesh's own twins come first; only its borders are matched by place.
#include "shared/mesh/adjacency.h"

#include <algorithm>
#include <array>

namespace limn {
namespace {

struct BorderEdge {
  std::array<int, 6> ends;  // places of its lower and its higher end
  HalfEdgeId halfEdge;
  bool isUpward;  // from the lower to the higher
};

std::vector<BorderEdge> bordersByPlace(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions) {
  std::vector<BorderEdge> borders;
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (mesh.twin(h) != kNone) continue;
    const glm::ivec3& a = positions[mesh.origin(h)];
    const glm::ivec3& b = positions[mesh.target(h)];
    std::array<int, 6> ends = {a.x, a.y, a.z, b.x, b.y, b.z};
    const std::array<int, 6> turned = {b.x, b.y, b.z, a.x, a.y, a.z};
    const bool isUpward = ends < turned;
    borders.push_back({isUpward ? ends : turned, h, isUpward});
  }
  std::sort(borders.begin(), borders.end(), [](const BorderEdge& a, const BorderEdge& b) {
    return a.ends != b.ends ? a.ends < b.ends : a.halfEdge < b.halfEdge;
  });
  return borders;
}

}  // namespace

std::vector<std::uint32_t> trianglesWithAdjacency(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions) {
  const auto opposite = [&mesh](HalfEdgeId h) { return mesh.origin(HalfEdgeMesh::prev(h)); };
  std::vector<std::uint32_t> indices;
  indices.reserve(2 * mesh.origins.size());
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    indices.push_back(mesh.origin(h));
    indices.push_back(opposite(mesh.twin(h) == kNone ? h : mesh.twin(h)));
  }
  const std::vector<BorderEdge> borders = bordersByPlace(mesh, positions);
  for (std::size_t i = 0; i < borders.size();) {
    std::size_t end = i + 1;
    while (end < borders.size() && borders[end].ends == borders[i].ends)
      ++end;
    if (end - i == 2 && borders[i].isUpward != borders[i + 1].isUpward) {
      const HalfEdgeId a = borders[i].halfEdge;
      const HalfEdgeId b = borders[i + 1].halfEdge;
      indices[2 * a + 1] = opposite(b);
      indices[2 * b + 1] = opposite(a);
    }
    i = end;
  }
  return indices;
}

std::vector<std::uint32_t> edgesWithOpposites(
    const HalfEdgeMesh& mesh,
    std::span<const std::uint32_t> adjacency) {
  std::vector<std::uint32_t> edges;
  edges.reserve(2 * mesh.origins.size());
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (mesh.twin(h) < h) continue;  // kNone is above all
    const std::uint32_t own = mesh.origin(HalfEdgeMesh::prev(h));
    edges.insert(edges.end(), {mesh.origin(h), mesh.target(h), own, adjacency[2 * h + 1]});
  }
  return edges;
}

}  // namespace limn
