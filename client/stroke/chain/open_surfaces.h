// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"

#include "shared/mesh/cracks.h"
#include "shared/mesh/half_edge.h"
#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// The parts of a mesh into which one can look: connected surfaces (also across cracks) with a
/// border, as large in one direction as what their openings let be seen. Constant after
/// construction. Threads: reentrant.
class OpenSurfaces {
 public:
  /// Cost: O(faces); O(half-edges) to find that there is no border.
  OpenSurfaces(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      const Cracks& cracks);

  /// Sets PolylineSet::Line::back for a view's lines: the most of the surfaces that a line runs
  /// over. Cost: O(points), nothing where all is closed.
  void markBacks(const SilhouetteView& view, PolylineSet& lines) const;

  /// Of a face's surface. It is turned so where, through its openings or since it is a sheet, more
  /// of its back side shows than kLeastShare of its area.
  [[nodiscard]] PolylineSet::Back backOf(FaceId face, const SilhouetteView& view) const;

  static constexpr double kLeastShare = 0.02;

 private:
  struct Part {
    glm::dvec3 vectorArea{0.0};  // sum of its faces' normals times their areas, grid units²
    glm::dvec3 centre{0.0};      // of area
    double area = 0.0;
  };

  std::vector<std::uint32_t> partOf_;  // by face; kNone: closed. Empty: all are.
  std::vector<Part> parts_;
};

}  // namespace limn
