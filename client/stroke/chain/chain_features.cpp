// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/chain.h"
#include "client/stroke/chain/crack_places.h"

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
    LineKind kind,
    const HalfEdgeMesh& mesh,
    std::span<const std::uint8_t> features,
    std::span<const Crack> cracks,
    HalfEdgeId h) {
  if (mesh.twins[h] == kNone) {
    const Crack crack = cracks.empty() ? Crack::kNot : cracks[h];
    return (kind == LineKind::kBorder && crack == Crack::kNot) ||
           (kind == LineKind::kCrease && crack == Crack::kCrease);
  }
  if (features.empty() || h > mesh.twins[h]) return false;
  const bool isCrease = (features[h] & kFeatureCrease) != 0;
  if (kind == LineKind::kCrease) return isCrease;
  return kind == LineKind::kSeam && !isCrease && (features[h] & kFeatureSeam) != 0;
}

struct Pairing {
  float cosTurn;
  std::uint32_t a;
  std::uint32_t b;
};

// Pairs the ends at each place, straightest first; none that turns more than the corner angle.
void pairEnds(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    float cosCorner,
    CrackPlaces& places,
    FeatureGraph& graph) {
  const auto ends = static_cast<std::uint32_t>(2 * graph.edges.size());
  std::vector<std::uint32_t> placeOf(ends);
  for (std::uint32_t end = 0; end < ends; ++end) {
    const HalfEdgeId h = graph.edges[end / 2];
    placeOf[end] = places.placeOf(end % 2 == 0 ? mesh.origin(h) : mesh.target(h));
  }
  const auto directionFrom = [&](std::uint32_t end) {
    const HalfEdgeId h = graph.edges[end / 2];
    const glm::vec3 along(positions[mesh.target(h)] - positions[mesh.origin(h)]);
    const float length = glm::length(along);
    if (length == 0.0F) return glm::vec3(0.0F);
    return (end % 2 == 0 ? along : -along) / length;
  };
  std::vector<std::uint32_t> byPlace(ends);
  for (std::uint32_t end = 0; end < ends; ++end)
    byPlace[end] = end;
  std::stable_sort(byPlace.begin(), byPlace.end(), [&](std::uint32_t a, std::uint32_t b) {
    return placeOf[a] < placeOf[b];
  });
  graph.partners.assign(ends, kNone);
  std::vector<Pairing> pairings;
  for (std::size_t first = 0; first < byPlace.size();) {
    std::size_t past = first + 1;
    while (past < byPlace.size() && placeOf[byPlace[past]] == placeOf[byPlace[first]])
      ++past;
    pairings.clear();
    for (std::size_t i = first; i < past; ++i) {
      for (std::size_t j = i + 1; j < past; ++j) {
        const float cosTurn = -glm::dot(directionFrom(byPlace[i]), directionFrom(byPlace[j]));
        if (cosTurn >= cosCorner) pairings.push_back({cosTurn, byPlace[i], byPlace[j]});
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
      bool isBackwards = end % 2 == 1;
      if (isBackwards && mesh.twins[h] != kNone) {  // a crack has this one only
        h = mesh.twins[h];
        isBackwards = false;
      }
      set.points.emplace_back(positions[isBackwards ? mesh.target(h) : mesh.origin(h)]);
      set.halfEdges.push_back(h);
      set.faces.push_back(HalfEdgeMesh::face(h));
      const std::uint32_t following = graph.partners[end ^ 1U];
      line.closed = following == start;
      if (following == kNone || line.closed) {
        if (!line.closed) {
          set.points.emplace_back(positions[isBackwards ? mesh.origin(h) : mesh.target(h)]);
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
  CrackPlaces places(mesh, positions);
  for (const LineKind kind : {LineKind::kCrease, LineKind::kSeam, LineKind::kBorder}) {
    FeatureGraph graph;
    for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
      if (isOfKind(kind, mesh, features, options.cracks, h)) graph.edges.push_back(h);
    }
    pairEnds(mesh, positions, cosCorner, places, graph);
    emitLines(mesh, positions, kind, graph, set);
  }
  return set;
}

}  // namespace limn
