// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace limn {

/// Two open pyramids on one axis, anchored cones [Sander00 §5] with four sides: from inside the
/// front one every plane of a cluster is seen from its front, from inside the back one every plane
/// from its back. Normals fill a rectangle about the axis, and those of a surface often a narrow
/// one: it bends one way more than the other. With q = eye − center, the eye is inside the front
/// one where q · axis + front > |q · side1| + |q · side2|, inside the back one where q · axis +
/// back < −(…). Conservative: the planes may be alike outside both, too.
struct AnchoredPyramid {
  static constexpr double kScale = 32767.0;  // the longest of the three vectors is about so long

  glm::vec3 center{0.0F};
  std::array<std::int16_t, 3> axis{};
  std::array<std::int16_t, 3> side1{};
  std::array<std::int16_t, 3> side2{};
  float front = -1.0F;  // as it stands, both pyramids are empty
  float back = 1.0F;
};

/// Rounding that a test of an AnchoredPyramid in floats must allow for, so that it never claims
/// what the float values of the planes deny. The predicate n·p + d of a plane, evaluated in floats
/// in any order, is off by at most 4.01 u (|p| + |d|/|n|) |n|, u = 2⁻²⁴. A unit normal is t (axis +
/// x side1 + y side2) with |x|, |y| ≤ 1, so 1/t is at most L, the three lengths' sum, and the test
/// is about values over t. Evaluating it is off by at most 7 u |q| L + 3 u |D| L, with D the
/// plane's distance from the center; with L ≤ 3 kScale and |D| ≤ 2 extent that is 54 u together.
struct PyramidSlack {
  static constexpr float kDistance = 0x1p-18F;  // × (|eye| + extent) × kScale: 64 u
};

/// Fits pyramids to planes (xyz: normal of any length, w: offset), about `center`, a point among
/// them. With a zero plane (back from everywhere), or normals that are too far apart, both are
/// empty. tangentScale: 1; other factors on the sides break the guarantee (for negative controls).
/// Cost: O(planes).
[[nodiscard]] AnchoredPyramid fitAnchoredPyramid(
    std::span<const glm::vec4> planes,
    const glm::vec3& center,
    double tangentScale = 1.0);

enum class PlanesSide { kFront, kBack, kUnknown };

/// From where the homogeneous eye (point, 1) or (direction, 0) sees the planes. extent: bound of
/// |d|/|n| over the planes and of |center|. One at a time: the reference for vectorised tests.
[[nodiscard]] PlanesSide sideOf(const AnchoredPyramid& pyramid, const glm::vec4& eye, float extent);

}  // namespace limn
