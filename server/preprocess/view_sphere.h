// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstdint>

namespace limn {

/// The view sphere of papers/002, section 3.2, in cells: one bit for each of 49 pairs of opposite
/// directions (the primitive integer vectors with components up to 2), set where a face with this
/// normal looks into the first of them. Two faces whose bits differ in k places have a silhouette
/// between them from k of 49 view directions. Exact for integer normals up to 2^50.
[[nodiscard]] std::uint64_t facingCells(const glm::dvec3& normal);

inline constexpr int kViewCells = 49;

}  // namespace limn
