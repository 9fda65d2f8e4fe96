// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <span>

namespace limn {

/// The view sphere of papers/002, section 3.2, in cells: 49 pairs of opposite view directions, the
/// primitive integer vectors with components up to 2.
inline constexpr int kViewCells = 49;

/// The cells from which a silhouette is seen between faces with these normals (of any length): some
/// look there and some away. Deterministic: products and sums of floats only. Cost: 20 ns a normal.
[[nodiscard]] int silhouetteCells(std::span<const glm::vec3> normals);

}  // namespace limn
