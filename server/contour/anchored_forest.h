// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/contour/forest_joins.h"
#include "server/contour/node_cones.h"

#include "shared/silhouette/detector.h"
#include "shared/silhouette/field.h"

#include <cstdint>
#include <vector>

namespace limn {

/// The search structure of papers/003 for silhouettes of edges [Sander00 §5]: a forest of nodes
/// with any number of edges and children, each with a pair of anchored cones. Finds every
/// silhouette, and the same ones as brute force. Threads: one caller at a time. See README.md for
/// why the server searches the cone tree of shared/silhouette instead.
class AnchoredForest {
 public:
  /// field: kEdges; must outlive it. Cost: O(edges · log edges), see joinEdges.
  explicit AnchoredForest(const SilhouetteField& field, const ForestCost& cost = {});

  /// The result stays valid until the next call. stats: sitesTested has two planes for each edge
  /// tested, clustersTested the nodes.
  [[nodiscard]] const SilhouetteResult& detect(const SilhouetteView& view);

  [[nodiscard]] std::size_t nodeCount() const { return nodes_.size(); }

  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  struct Node {
    NodeCones cones;
    std::uint32_t edgeBegin = 0;
    std::uint32_t edgeEnd = 0;
    std::uint32_t past = 0;  // where to go on when its cones hold the eye
  };

  struct Edge {
    HalfEdgeId half = 0;
    HalfEdgeId twin = 0;
    std::uint32_t plane = 0;  // of half's face, in planes_
    std::uint32_t twinPlane = 0;
  };

  const SilhouetteField& field_;
  std::vector<Node> nodes_;        // depth first
  std::vector<Edge> edges_;        // by node
  std::vector<glm::vec4> planes_;  // of faces, in the order in which edges ask for them
  std::vector<HalfEdgeId> found_;  // before it is known how many
  SilhouetteResult result_;
};

}  // namespace limn
