// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <span>

namespace limn {

/// The point of the convex hull of `points` closest to the origin, 0 when the hull holds it.
/// points: at least one, coordinates about 1. accuracy: of the square of its distance. Where it is
/// not 0 for unit vectors they lie in a half space, and its direction is the axis of the narrowest
/// cone around them [Sander00 §5].
/// Threads: reentrant. Cost: O(points) a step, ten steps as a rule.
[[nodiscard]] glm::dvec3 closestPointOfHull(
    std::span<const glm::dvec3> points,
    double accuracy = 1e-12);

}  // namespace limn
