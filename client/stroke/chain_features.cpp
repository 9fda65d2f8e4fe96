// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain.h"

#include "shared/progressive/vertex_split.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

// Edges of one kind, each as one half-edge, and what each end goes on to. End 2e is the origin of
// edges[e], end 2e + 1 its target.
struct FeatureGraph {
  std::vector<HalfEdgeId> edges;
  std::vector<std::uint32_t> partners;  // by end: the end that continues it, or kNone
};

bool isOfKind(
    const HalfEdgeMesh& mesh,
    std::span<const std::uint8_t> features,
    HalfEdgeId h,
    LineKind kind) {
  const bool isBorder = mesh.twins[h] == kNone;
  if (kind == LineKind::kBorder) return isBorder;
  if (isBorder || features.empty() || h > mesh.twins[h]) return false;
  const bool isCrease = (features[h] & kFeatureCrease) != 0;
  return kind == LineKind::kCrease ? isCrease : !isCrease && (features[h] & kFeatureSeam) != 0;
}

struct Pairing {
  float cosTurn;
  std::uint32_t a;
  std::uint32_t b;
};

// Pairs the ends at each vertex, straightest first; none that turns more than the corner angle.
void pairEnds(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    float cosCorner,
    FeatureGraph& graph) {
  const auto ends = static_cast<std::uint32_t>(2 * graph.edges.size());
  const auto vertexOf = [&](std::uint32_t end) {
    const HalfEdgeId h = graph.edges[end / 2];
    return end % 2 == 0 ? mesh.origin(h) : mesh.target(h);
  };
  const auto directionFrom = [&](std::uint32_t end) {
    const HalfEdgeId h = graph.edges[end / 2];
    const glm::vec3 along(positions[mesh.target(h)] - positions[mesh.origin(h)]);
    const float length = glm::length(along);
    if (length == 0.0F) return glm::vec3(0.0F);
    return (end % 2 == 0 ? along : -along) / length;
  };
  std::vector<std::uint32_t> byVertex(ends);
  for (std::uint32_t end = 0; end < ends; ++end)
    byVertex[end] = end;
  std::stable_sort(byVertex.begin(), byVertex.end(), [&](std::uint32_t a, std::uint32_t b) {
    return vertexOf(a) < vertexOf(b);
  });
  graph.partners.assign(ends, kNone);
  std::vector<Pairing> pairings;
  for (std::size_t first = 0; first < byVertex.size();) {
    std::size_t past = first + 1;
    while (past < byVertex.size() && vertexOf(byVertex[past]) == vertexOf(byVertex[first]))
      ++past;
    pairings.clear();
    for (std::size_t i = first; i < past; ++i) {
      for (std::size_t j = i + 1; j < past; ++j) {
        const float cosTurn = -glm::dot(directionFrom(byVertex[i]), directionFrom(byVertex[j]));
        if (cosTurn >= cosCorner) pairings.push_back({cosTurn, byVertex[i], byVertex[j]});
      }
    }
    std::stable_sort(pairings.begin(), pairings.end(), [](const Pairing& p, const Pairing& q) {
      return p.cosTurn > q.cosTurn;
    });
    for (const Pairing& p : pairings) {
      if (graph.partners[p.a] != kNone || graph.partners[p.b] != kNone) continue;
      graph.partners[p.a] = p.b;
      graph.partners[p.b] = p.a;
    }
    first = past;
  }
}

// Walks every line of the graph: open ones from their ends, then loops.
void emitLines(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    LineKind kind,
    const FeatureGraph& graph,
    PolylineSet& set) {
  std::vector<std::uint8_t> isUsed(graph.edges.size(), 0);
  const auto walkFrom = [&](std::uint32_t start) {  // an end: the line leaves it along its edge
    PolylineSet::Line line;
    line.kind = kind;
    line.begin = static_cast<std::uint32_t>(set.points.size());
    std::uint32_t end = start;
    for (;;) {
      const std::uint32_t e = end / 2;
      isUsed[e] = 1;
      HalfEdgeId h = graph.edges[e];
      if (end % 2 == 1) h = mesh.twins[h];  // walked backwards; borders never are
      set.points.emplace_back(positions[mesh.origin(h)]);
      set.halfEdges.push_back(h);
      set.faces.push_back(HalfEdgeMesh::face(h));
      const std::uint32_t following = graph.partners[end ^ 1U];
      line.closed = following == start;
      if (following == kNone || line.closed) {
        if (!line.closed) {
          set.points.emplace_back(positions[mesh.target(h)]);
          set.halfEdges.push_back(kNone);
          set.faces.push_back(kNone);
        }
        break;
      }
      end = following;
    }
    line.end = static_cast<std::uint32_t>(set.points.size());
    set.lines.push_back(line);
  };
  // A border line runs as its half-edges do, so it starts at an origin.
  const std::uint32_t stride = kind == LineKind::kBorder ? 2 : 1;
  const auto ends = static_cast<std::uint32_t>(graph.partners.size());
  for (std::uint32_t end = 0; end < ends; end += stride) {
    if (isUsed[end / 2] == 0 && graph.partners[end] == kNone) walkFrom(end);
  }
  for (std::uint32_t end = 0; end < ends; end += 2) {
    if (isUsed[end / 2] == 0) walkFrom(end);
  }
}

}  // namespace

PolylineSet chainFeatures(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    std::span<const std::uint8_t> features,
    const FeatureChainOptions& options) {
  PolylineSet set;
  const auto cosCorner =
      static_cast<float>(std::cos(options.cornerAngleDegrees * std::numbers::pi / 180.0));
  for (const LineKind kind : {LineKind::kCrease, LineKind::kSeam, LineKind::kBorder}) {
    FeatureGraph graph;
    for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
      if (isOfKind(mesh, features, h, kind)) graph.edges.push_back(h);
    }
    pairEnds(mesh, positions, cosCorner, graph);
    emitLines(mesh, positions, kind, graph, set);
  }
  return set;
}

}  // namespace limn
