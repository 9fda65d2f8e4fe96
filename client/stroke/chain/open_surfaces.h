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

/// The parts of a mesh that have a border: connected surfaces, also across cracks, whose back side
/// may be seen through openings. Constant after construction. Threads: reentrant.
class OpenSurfaces {
 public:
  /// Cost: O(faces + cracks · log cracks); a look at every half-edge where there is no border.
  OpenSurfaces(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      const Cracks& cracks);

  /// Sets PolylineSet::Line::back for a view's lines: the most of the surfaces that a line runs
  /// over. Cost: O(points), nothing where all is closed.
  void markBacks(const SilhouetteView& view, PolylineSet& lines) const;

  /// Of a face's surface. kSeen where, through its openings or since it is a sheet, more of its
  /// back side shows than of its front, by kLeastShare of its area.
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
