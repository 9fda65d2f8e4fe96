// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/rng.h"

#include <glm/glm.hpp>

#include <optional>
#include <span>

namespace limn {

/// The points with normal · x ≥ offset. `normal` has length 1.
struct HalfSpace {
  glm::dvec3 normal{0.0, 0.0, 1.0};
  double offset = 0.0;
};

/// What solveLinearProgram minimises: direction · x + |x|² / (2 reach). Without its second part the
/// minimum of a linear program may be a whole edge or face of the feasible region, or nowhere; with
/// it there is one minimum, which is the point of the region closest to −reach · direction. The
/// larger the reach, the closer to the linear program's minimum.
struct LinearGoal {
  glm::dvec3 direction{0.0};  // length at most 1
  double reach = 1e5;
};

/// A linear program in three variables, regularised [Seidel91]: the point that satisfies all
/// constraints and minimises `goal`, or nullopt when no point does. Scale the problem so that its
/// coordinates are about 1: constraints hold to about 1e-10 then. `order` shuffles `constraints`
/// in place. Threads: reentrant. Cost: expected O(constraints), about a microsecond for a dozen.
[[nodiscard]] std::optional<glm::dvec3>
solveLinearProgram(std::span<HalfSpace> constraints, const LinearGoal& goal, Rng& order);

}  // namespace limn
