// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. V. Sander, X. Gu, S. J. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping",
// SIGGRAPH 2000, section 5. Deviation: nodes lie depth first, so the recursion is a loop.
#include "server/contour/anchored_forest.h"

#include "shared/core/assert.h"

#include <algorithm>

namespace limn {
namespace {

/// Faces of ranges of edges, each face once.
class FaceCollector {
 public:
  explicit FaceCollector(const SilhouetteField& field)
      : field_(field),
        stamps_(field.mesh().faceCount(), 0) {}

  NodeCones conesOf(std::span<const HalfEdgeId> edges, Rng& order) {
    ++stamp_;
    planes_.clear();
    const HalfEdgeMesh& mesh = field_.mesh();
    glm::ivec3 low(0x7FFFFFFF);
    glm::ivec3 high(-0x7FFFFFFF);
    for (const HalfEdgeId h : edges) {
      for (const HalfEdgeId side : {h, mesh.twin(h)}) {
        const FaceId f = HalfEdgeMesh::face(side);
        if (stamps_[f] == stamp_) continue;
        stamps_[f] = stamp_;
        planes_.push_back(field_.plane(f));
        for (std::uint32_t k = 0; k < 3; ++k) {
          const glm::ivec3 p = field_.positions()[mesh.origin(3 * f + k)];
          low = glm::min(low, p);
          high = glm::max(high, p);
        }
      }
    }
    const glm::dvec3 center =
        0.5 * (glm::dvec3(low) + glm::dvec3(high)) - glm::dvec3(field_.center());
    const double radius = std::max(1.0, 0.5 * glm::length(glm::dvec3(high - low)));
    return fitNodeCones(planes_, center, radius, order);
  }

 private:
  const SilhouetteField& field_;
  std::vector<std::uint32_t> stamps_;  // by face
  std::uint32_t stamp_ = 0;
  std::vector<glm::vec4> planes_;
};

}  // namespace

AnchoredForest::AnchoredForest(const SilhouetteField& field, const ForestCost& cost)
    : field_(field) {
  LIMN_ASSERT(field.kind() == SilhouetteKind::kEdges);
  const ForestShape shape = joinEdges(field, cost);
  FaceCollector collector(field);
  Rng order(1);
  nodes_.reserve(shape.nodes.size());
  for (const ForestShape::Node& node : shape.nodes) {
    const std::uint32_t end = shape.nodes[node.past - 1].edgeEnd;
    const auto below = std::span(shape.edges).subspan(node.edgeBegin, end - node.edgeBegin);
    nodes_.push_back({collector.conesOf(below, order), node.edgeBegin, node.edgeEnd, node.past});
  }
  edges_.reserve(shape.edges.size());
  std::vector<std::uint32_t> planeOf(field.mesh().faceCount(), kNone);
  planes_.reserve(planeOf.size());
  const auto place = [&](HalfEdgeId h) {
    std::uint32_t& plane = planeOf[HalfEdgeMesh::face(h)];
    if (plane == kNone) {
      plane = static_cast<std::uint32_t>(planes_.size());
      planes_.push_back(field.plane(HalfEdgeMesh::face(h)));
    }
    return plane;
  };
  for (const HalfEdgeId h : shape.edges) {
    const HalfEdgeId twin = field.mesh().twin(h);
    const std::uint32_t plane = place(h);
    edges_.push_back({h, twin, plane, place(twin)});
  }
}

const SilhouetteResult& AnchoredForest::detect(const SilhouetteView& view) {
  const glm::vec4 eye = field_.eyeOf(view);
  std::uint32_t tested = 0;
  std::uint32_t visited = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++visited) {
    const Node& node = nodes_[i];
    if (node.cones.contain(eye)) {
      i = node.past;
      continue;
    }
    const std::uint32_t edges = node.edgeEnd - node.edgeBegin;
    if (found_.size() < count + edges) found_.resize(2 * (count + edges));
    for (std::uint32_t e = node.edgeBegin; e < node.edgeEnd; ++e) {
      const Edge& edge = edges_[e];
      const bool front = SilhouetteField::valueAt(planes_[edge.plane], eye) > 0.0F;
      const bool twinFront = SilhouetteField::valueAt(planes_[edge.twinPlane], eye) > 0.0F;
      // Written in any case and kept if so: which way an edge goes cannot be foretold.
      found_[count] = front ? edge.half : edge.twin;
      count += front != twinFront ? 1 : 0;
    }
    tested += edges;
    ++i;
  }
  result_.edges.assign(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(count));
  result_.stats.clustersTested = visited;
  result_.stats.sitesTested = 2 * tested;
  result_.stats.facesVisited = 2 * tested;
  result_.stats.segments = static_cast<std::uint32_t>(count);
  return result_;
}

std::size_t AnchoredForest::memoryBytes() const {
  return nodes_.capacity() * sizeof(Node) + edges_.capacity() * sizeof(Edge) +
         planes_.capacity() * sizeof(glm::vec4);
}

}  // namespace limn
