// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/silhouette/field.h"

#include <cstdint>
#include <vector>

namespace limn {

/// What a search is predicted to cost [Sander00 §5], in tests of one edge.
struct ForestCost {
  double node = 3.0;      // the tests of one node's cones; 4/3 in the paper
  double eyeRadii = 4.0;  // eyes are anywhere in a ball of so many of the model's radii
};

/// A forest without its cones: nodes depth first, each with edges of its own.
struct ForestShape {
  struct Node {
    std::uint32_t edgeBegin = 0;  // its own edges are edges[edgeBegin … edgeEnd)
    std::uint32_t edgeEnd = 0;
    std::uint32_t past = 0;  // the first node that is not below it
  };

  std::vector<Node> nodes;
  std::vector<HalfEdgeId> edges;  // the smaller half-edge of each edge with two faces
};

/// Puts every edge of a field of edges into a node of its own and joins roots, best first, as long
/// as that makes a search cheaper. Candidates are roots with edges of a common face.
/// Deterministic. Cost: O(edges · log edges), some 20 µs an edge.
[[nodiscard]] ForestShape joinEdges(const SilhouetteField& field, const ForestCost& cost);

}  // namespace limn
