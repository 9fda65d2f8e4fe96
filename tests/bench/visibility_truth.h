// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/mesh/half_edge.h"

#include <glm/glm.hpp>

#include <memory>
#include <span>

namespace limn {

/// Whether mesh edges can be seen, by somebody else's rays: Embree's, robust, from the edge's
/// middle to the eye, past the edge's own two faces. Concave silhouettes are for the caller to rule
/// out.
class VisibilityTruth {
 public:
  VisibilityTruth() = default;
  VisibilityTruth(const VisibilityTruth&) = delete;
  VisibilityTruth& operator=(const VisibilityTruth&) = delete;
  virtual ~VisibilityTruth() = default;

  /// eye: grid units.
  [[nodiscard]] virtual bool isVisible(HalfEdgeId h, const glm::dvec3& eye) const = 0;

  /// Null when this program was built without Embree.
  [[nodiscard]] static std::unique_ptr<VisibilityTruth> create(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions);
};

}  // namespace limn
