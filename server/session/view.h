// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/messages.h"

#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/split_forest.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>

namespace limn {

/// A view in grid units, ready for testing thousands of splits.
struct View {
  /// What counts as in view.
  enum class Clip : std::uint8_t {
    kEverything,
    kPlanes,  // the frustum's four sides, and what is behind a perspective eye
    kCone,    // a cone around `forward` with coneHalfAngle
  };
  glm::dvec3 eye{0.0};
  /// The eye may be anywhere within this of `eye`; what may be seen then is not clipped.
  double eyeRadius = 0.0;
  glm::dvec3 forward{0.0, 0.0, -1.0};  // unit
  bool orthographic = false;
  /// A length projects to length · pixelsPerUnit pixels (orthographic) or length · pixelsPerUnit /
  /// distance.
  double pixelsPerUnit = 1.0;
  double errorPx = 1.0;
  protocol::Silhouette silhouette = protocol::Silhouette::kSmooth;
  Clip clip = Clip::kEverything;
  /// Planes: inward unit normals, and the signed distance a point on the plane has (0 for
  /// perspective, whose planes go through the eye; positions are relative to the eye).
  std::array<glm::dvec3, 4> planeNormals{};
  std::array<double, 4> planeOffsets{};
  double coneHalfAngle = 0.0;

  /// Whether a sphere (grid units) may be in view. Conservative: never false for one that is.
  [[nodiscard]] bool maySee(const glm::dvec3& center, double radius) const;
  /// Pixels that a length at the nearest point of a sphere covers at most.
  [[nodiscard]] double projectedPx(double length, const glm::dvec3& center, double radius) const;
};

/// The view of a pose (model units, checked by the protocol's decoder), its frustum widened by
/// a few percent for the width of strokes.
[[nodiscard]] View viewOfPose(const protocol::Pose& pose, const Grid& grid);

/// Whether two poses need the same of a model, whatever their ids and goals.
[[nodiscard]] bool sameView(const protocol::Pose& a, const protocol::Pose& b);

/// How a normal cone lies to the directions in which a sphere is seen.
enum class Facing : std::uint8_t { kFront, kStraddling, kBack };

/// Directions within an angle of an axis.
struct SplitCone {
  glm::vec3 axis{0.0F, 0.0F, 1.0F};  // unit
  float cos = -1.0F;                 // of the half-angle; −1: any direction
};

/// Conservative: kStraddling unless all normals of the cone, anywhere in the split's sphere, face
/// the eye (kFront) or none does (kBack).
[[nodiscard]] Facing facingOf(const View& view, const SplitBounds& bounds, const SplitCone& cone);

}  // namespace limn
