// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/rng.h"

#include <glm/glm.hpp>

#include <limits>
#include <span>

namespace limn {

/// Two open cones on opposite axes and of one angle, each with an origin of its own [Sander00 §5]:
/// from inside the front one all of some planes are seen from their front, from inside the back one
/// all from their back, also by the float values of SilhouetteField::valueAt. Places are about
/// the field's centre, grid units. As made by default: both are empty.
struct NodeCones {
  glm::vec3 scaledNormal{0.0F};  // the axis over the cosine of the cones' half-angle
  float separation = 0.0F;       // (front − back) · scaledNormal, and what rounding needs
  glm::vec3 front{std::numeric_limits<float>::quiet_NaN()};  // origins
  glm::vec3 back{std::numeric_limits<float>::quiet_NaN()};

  /// Whether either holds an eye (SilhouetteField::eyeOf): two dot products, as in the paper.
  [[nodiscard]] bool contain(const glm::vec4& eye) const {
    const glm::vec3 p(eye);
    const glm::vec3 fromFront = p - front * eye.w;
    const float along = glm::dot(fromFront, scaledNormal);
    if (along >= 0.0F) return along * along >= glm::dot(fromFront, fromFront);
    const float alongBack = along + separation * eye.w;
    const glm::vec3 fromBack = p - back * eye.w;
    return alongBack < 0.0F && alongBack * alongBack >= glm::dot(fromBack, fromBack);
  }
};

/// The largest cones for some planes (xyz: normal of any length, w: offset): their axis by
/// Gilbert's algorithm, their origins by two linear programs. Empty where the normals fit in no
/// half space, or a plane has no normal (it is back from everywhere). center, radius: a ball about
/// the faces of the planes; radius > 0. Cost: O(planes), some µs for a dozen.
[[nodiscard]] NodeCones fitNodeCones(
    std::span<const glm::vec4> planes,
    const glm::dvec3& center,
    double radius,
    Rng& order);

}  // namespace limn
