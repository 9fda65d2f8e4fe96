// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>

namespace limn::hull {

using Triangle = std::array<glm::ivec3, 3>;
using Corners = std::array<std::uint32_t, 3>;  // which vertices a triangle's corners are

/// Whether two triangles have a point in common, touching included. Exact. Triangles without area
/// have none in common with anything. Cost: some 50 to 200 ns.
[[nodiscard]] bool trianglesMeet(const Triangle& s, const Triangle& t);

/// The same for triangles that share corner 0 of both, that corner aside.
[[nodiscard]] bool trianglesMeetBesidesCorner(const Triangle& s, const Triangle& t);

/// The same for triangles that share the edge of corners 0 and 1 of both (in any order), the edge
/// aside: whether one is folded onto the other.
[[nodiscard]] bool trianglesMeetBesidesEdge(const Triangle& s, const Triangle& t);

/// Whether two triangles of a mesh have a point in common besides the corners or the edge that they
/// share. Two of the same three corners do.
[[nodiscard]] bool
facesMeet(const Corners& cornersS, const Triangle& s, const Corners& cornersT, const Triangle& t);

}  // namespace limn::hull
