// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

enum class LineKind : std::uint8_t { kSilhouette, kCrease, kBorder, kSeam };

/// Chained lines, flat. Points are in grid units of the model (Grid::toModel makes them model
/// units), so that polygonal lines are exact.
struct PolylineSet {
  struct Line {
    LineKind kind = LineKind::kSilhouette;
    bool closed = false;      // the first point is not repeated
    std::uint32_t begin = 0;  // points[begin … end)
    std::uint32_t end = 0;
    /// A light's silhouette: it runs over the surface, not where that turns away from the eye.
    bool onSurface = false;

    /// Segments: end − begin for a closed line, one fewer for an open one.
    [[nodiscard]] std::uint32_t segmentCount() const { return end - begin - (closed ? 0 : 1); }
  };

  std::vector<glm::vec3> points;
  std::vector<Line> lines;
  /// Parallel to points: the half-edge of the segment that starts at this point (polygonal lines:
  /// the edge itself; smooth silhouettes: kNone). An open line's last entry is kNone.
  std::vector<HalfEdgeId> halfEdges;
  /// Parallel to points: the front-facing (visible-side) face of the segment that starts there.
  std::vector<FaceId> faces;
};

}  // namespace limn
