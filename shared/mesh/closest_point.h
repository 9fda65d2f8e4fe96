// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

namespace limn {

/// The point of triangle abc closest to p [Ericson04, "Real-Time Collision Detection", 5.1.5].
/// Degenerate triangles are treated as what they are, a segment or a point.
[[nodiscard]] glm::dvec3 closestPointOnTriangle(
    const glm::dvec3& p,
    const glm::dvec3& a,
    const glm::dvec3& b,
    const glm::dvec3& c);

}  // namespace limn
