// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/base_reach.h"

#include "shared/core/disjoint_sets.h"
#include "shared/mesh/half_edge.h"

#include <vector>

namespace limn {
namespace {

std::string counted(std::uint32_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

MeshTopology topologyOf(const TriangleMesh& mesh) {
  MeshTopology topology;
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  const auto links = HalfEdgeMesh::build(vertices, mesh.triangles);
  if (!links) return topology;

  DisjointSets pieces(vertices);
  std::int64_t sides = 0;  // half-edges without twin
  std::vector<HalfEdgeId> borderFrom(vertices, kNone);
  for (HalfEdgeId h = 0; h < links->twins.size(); ++h) {
    pieces.join(links->origin(h), links->target(h));
    if (links->twin(h) != kNone) continue;
    ++sides;
    borderFrom[links->origin(h)] = h;
  }
  for (std::uint32_t v = 0; v < vertices; ++v)
    topology.pieces += pieces.rootOf(v) == v ? 1 : 0;
  // Of a border vertex of a manifold one border half-edge leaves.
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (borderFrom[v] == kNone) continue;
    ++topology.holes;
    for (std::uint32_t w = v; borderFrom[w] != kNone;) {
      const HalfEdgeId h = borderFrom[w];
      borderFrom[w] = kNone;
      w = links->target(h);
    }
  }
  // Euler: V − E + F = 2 · pieces − 2 · tunnels − holes.
  const std::int64_t faces = links->faceCount();
  const std::int64_t edges = (3 * faces + sides) / 2;
  const std::int64_t euler = std::int64_t{vertices} - edges + faces;
  topology.tunnels = static_cast<std::uint32_t>(
      (2 * std::int64_t{topology.pieces} - std::int64_t{topology.holes} - euler) / 2);
  return topology;
}

std::string
whyBaseIsLarger(std::uint32_t faces, std::uint32_t asked, const MeshTopology& topology) {
  if (faces <= asked) return {};
  return "the base mesh has " + counted(faces, "face") + ", not " + std::to_string(asked) +
         ": that is as small as it gets with " + counted(topology.pieces, "piece") + ", " +
         counted(topology.holes, "hole") + " and " + counted(topology.tunnels, "tunnel") +
         ", none of which simplification may remove";
}

}  // namespace limn
