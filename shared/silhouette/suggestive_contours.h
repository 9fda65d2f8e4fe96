// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/surface_segment.h"
#include "shared/silhouette/curvature.h"
#include "shared/silhouette/field.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Limits without a unit, relative to the surface's feature size; the defaults are rtsc's.
struct SuggestiveOptions {
  float threshold = 0.01F;  // of the radial curvature's derivative along the view
  float fade = 0.03F;  // strength is ½ where the derivative is this much above it; 0: always 1
};

/// Lines where a surface would turn away from the eye if it were looked at from a little aside
/// [DeCarlo03]: the radial curvature (along the view, projected onto the surface) is zero and
/// increases towards the eye by more than the threshold. Keeps its memory from view to view.
/// Threads: one caller at a time.
class SuggestiveContours {
 public:
  /// Refers to all three, which must outlive it unchanged.
  SuggestiveContours(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      const SurfaceCurvature& curvature,
      const SuggestiveOptions& options = {})
      : mesh_(mesh),
        positions_(positions),
        curvature_(curvature),
        options_(options) {}

  /// Of the surface's front side; the nodes are edgeNode(). Valid until the next call.
  /// Cost: O(vertices + faces).
  [[nodiscard]] std::span<const SurfaceSegment> find(const SilhouetteView& view);

 private:
  void evaluate(const SilhouetteView& view);
  void cross(FaceId face);

  /// What a view makes of a vertex.
  struct Value {
    float facing = 0.0F;      // normal · view
    float curvature = 0.0F;   // radial, times sin² of the angle between view and normal
    float derivative = 0.0F;  // its derivative along the view less the threshold, times `facing`
  };

  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  const SurfaceCurvature& curvature_;
  SuggestiveOptions options_;
  std::vector<Value> values_;
  std::vector<std::uint8_t> signs_;  // what most faces are passed over by: small enough for a cache
  std::vector<SurfaceSegment> segments_;
};

}  // namespace limn
