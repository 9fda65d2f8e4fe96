// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <span>

namespace limn {

/// Two open cones on one axis [Sander00 §5]: from inside the front one every plane of a cluster is
/// seen from its front, from inside the back one every plane from its back. The apexes are
/// center + front · axis and center + back · axis, the half-angle is the complement of the normals'
/// cone. Conservative: the planes may be alike outside both, too.
struct AnchoredCone {
  glm::vec3 center{0.0F};
  glm::vec3 axis{0.0F, 0.0F, 1.0F};
  float front = 0.0F;        // apex of the front cone, along the axis
  float back = 0.0F;         // apex of the back cone, along the axis
  float cotSquared = -1.0F;  // (cot of the normals' half-angle)²; negative: both cones are empty
};

/// Rounding that a test of an AnchoredCone in floats must allow for, so that it never claims what
/// the float values of the planes deny. The predicate n·p + d of a plane, evaluated in floats in
/// any order, is off by at most 4.01 u (|p| + |d|/|n|) |n|, u = 2⁻²⁴. Fitted cones hold no normal
/// more than acos(kMinCosine) from the axis, so moving an apex by 1/kMinCosine times that along the
/// axis makes up for it; evaluating the test itself adds about as much again.
struct ConeSlack {
  static constexpr double kMinCosine = 0.1;
  static constexpr float kDistance = 0x1p-18F;  // × (|eye| + extent): 64 u
  static constexpr float kSquare = 0x1p-19F;    // × |eye − center|²: 32 u
};

/// Fits cones to planes (xyz: normal of any length, w: offset), about `center`, a point among
/// them. With a zero plane (back from everywhere) both cones are empty. tangentScale: 1; other
/// factors on the tangent of the normals' half-angle break the guarantee (for negative controls).
/// Cost: O(planes).
[[nodiscard]] AnchoredCone fitAnchoredCone(
    std::span<const glm::vec4> planes,
    const glm::vec3& center,
    double tangentScale = 1.0);

enum class ConeSide { kFront, kBack, kUnknown };

/// Where the homogeneous eye (point, 1) or (direction, 0) is. extent: bound of |d|/|n| over the
/// planes and of |center|. One cone at a time: the reference for vectorised tests.
[[nodiscard]] ConeSide sideOf(const AnchoredCone& cone, const glm::vec4& eye, float extent);

}  // namespace limn
