// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>

namespace limn {

/// Normals in a map (protocol/SPEC.md, "Hull maps"): relative to the frame of the hull's face, so
/// that most are near (0, 0, 1) and none that a face shows is near the seam; as octahedra
/// [Cigolle14, "A survey of efficient representations for independent unit vectors"], seven bits a
/// coordinate, 64 for 0.

/// Columns: along the face's first edge, across it, out of it. Any unit frame for a face without
/// area.
[[nodiscard]] glm::dmat3
mapFrame(const glm::dvec3& corner0, const glm::dvec3& corner1, const glm::dvec3& corner2);

/// normal: unit, in the frame's own outer coordinates. Each of 1 to 127.
[[nodiscard]] std::array<std::uint8_t, 2> encodeMapNormal(
    const glm::dmat3& frame,
    const glm::dvec3& normal);

/// The reverse, unit; of any two bytes. To within 2 degrees.
[[nodiscard]] glm::dvec3 decodeMapNormal(
    const glm::dmat3& frame,
    const std::array<std::uint8_t, 2>& code);

}  // namespace limn
