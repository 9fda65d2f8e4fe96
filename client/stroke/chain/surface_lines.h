// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"

#include "shared/mesh/half_edge.h"
#include "shared/mesh/surface_segment.h"
#include "shared/silhouette/curvature.h"
#include "shared/silhouette/field.h"
#include "shared/silhouette/suggestive_contours.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <span>

namespace limn {

/// Appends the lines that segments make: through every node where exactly two of them end; loops
/// close. Where all segments of a line run one way, so does it. Cost: O(segments · log segments).
void chainSegments(std::span<const SurfaceSegment> segments, LineKind kind, PolylineSet& out);

/// Lines over a surface that mesh edges do not tell of, each kind if asked for.
struct SurfaceLineChoice {
  bool suggestive = false;
  bool ridge = false;
  bool valley = false;
  bool intersection = false;

  [[nodiscard]] bool any() const { return suggestive || ridge || valley || intersection; }
};

/// Finds them on one mesh, which must outlive it unchanged. What does not depend on the view is
/// found once. Threads: one caller at a time.
class SurfaceLines {
 public:
  /// features: one byte a half-edge, or none; where they have creases a surface has no curvature.
  /// Cost: O(faces), about 1 µs each.
  SurfaceLines(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      std::span<const std::uint8_t> features,
      const SurfaceLineChoice& choice);
  SurfaceLines(const SurfaceLines&) = delete;
  SurfaceLines& operator=(const SurfaceLines&) = delete;

  /// Appends all lines of the choice as they are from there. Cost: O(vertices + faces) for
  /// suggestive contours, else O(lines).
  void append(const SilhouetteView& view, PolylineSet& lines);

 private:
  SurfaceCurvature curvature_;  // for suggestive contours
  std::optional<SuggestiveContours> suggestive_;
  PolylineSet fixed_;
};

}  // namespace limn
