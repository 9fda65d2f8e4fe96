// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Precomputed silhouette seeds [Mohr13 §3.2.4]: for each of a set of viewpoints the vertices where
/// contour loops can be picked up, most visible first. A seed whose vertex a client does not hold
/// yet stands for its nearest ancestor that it holds; `nodes` has the ancestors for that.
struct SeedTable {
  /// A seed vertex or an ancestor of one; sorted by id, so parents come before children.
  struct Node {
    VertexId vertex = kNone;
    std::uint32_t parent = kNone;  // index into nodes; kNone: a vertex of the base mesh
  };

  std::vector<glm::vec3> directions;     // viewpoints: unit vectors from the model's centre
  std::vector<std::uint32_t> seedBegin;  // directions + 1 offsets into seeds
  std::vector<std::uint32_t> seeds;      // indices into nodes
  std::vector<Node> nodes;
};

}  // namespace limn
