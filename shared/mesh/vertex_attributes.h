// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace limn {

using SrgbColor = glm::vec<3, std::uint8_t>;

/// A unit normal on the octahedron's lattice: s and t of protocol/SPEC.md, "Attributes", plus
/// kOctRadius, so 0 to 2 · kOctRadius each (10 bits; 0.1° at most off).
using OctNormal = glm::vec<2, std::uint16_t>;

inline constexpr std::int32_t kOctRadius = 511;

/// What the vertices and edges of a model carry besides positions; bits (ModelInfo.attributes).
enum AttributeKind : std::uint8_t {
  kAttributeColors = 1,
  kAttributeNormals = 2,
  kAttributeSeams = 4,  // edges between colours or materials: kFeatureSeam
};

inline constexpr std::uint8_t kAllAttributeKinds =
    kAttributeColors | kAttributeNormals | kAttributeSeams;

/// Of one vertex; what the model does not have stays as it is here.
struct VertexAttributes {
  SrgbColor color{0};
  OctNormal normal{0};
  friend bool operator==(const VertexAttributes&, const VertexAttributes&) = default;
};

/// Of a mesh: each array empty or one entry a vertex.
struct AttributeArrays {
  std::vector<SrgbColor> colors;
  std::vector<OctNormal> normals;

  [[nodiscard]] VertexAttributes at(std::size_t vertex) const {
    return {
        colors.empty() ? SrgbColor(0) : colors[vertex],
        normals.empty() ? OctNormal(0) : normals[vertex]};
  }

  /// kAttributeColors and kAttributeNormals.
  [[nodiscard]] std::uint8_t kinds() const {
    return static_cast<std::uint8_t>(
        (colors.empty() ? 0 : kAttributeColors) | (normals.empty() ? 0 : kAttributeNormals));
  }

  friend bool operator==(const AttributeArrays&, const AttributeArrays&) = default;
};

/// The point of the octahedron |x| + |y| + |z| = kOctRadius that (s, t), both within ±kOctRadius,
/// stand for: seen along z for z ≥ 0, the lower half folded out over the edges [Meyer10, "On
/// floating-point normal vectors"].
[[nodiscard]] inline glm::ivec3 octPoint(const glm::ivec2& st) {
  const glm::ivec2 size = glm::abs(st);
  const std::int32_t z = kOctRadius - size.x - size.y;
  if (z >= 0) return {st.x, st.y, z};
  return {
      st.x < 0 ? size.y - kOctRadius : kOctRadius - size.y,
      st.y < 0 ? size.x - kOctRadius : kOctRadius - size.x,
      z};
}

/// The other way round, for a point of the octahedron.
[[nodiscard]] inline glm::ivec2 octUnfold(const glm::ivec3& point) {
  if (point.z >= 0) return {point.x, point.y};
  const std::int32_t x = kOctRadius - std::abs(point.y);
  const std::int32_t y = kOctRadius - std::abs(point.x);
  return {point.x < 0 ? -x : x, point.y < 0 ? -y : y};
}

[[nodiscard]] inline glm::ivec3 octPoint(const OctNormal& normal) {
  return octPoint(glm::ivec2(normal) - kOctRadius);
}

[[nodiscard]] inline OctNormal octNormal(const glm::ivec3& point) {
  return OctNormal(octUnfold(point) + kOctRadius);
}

/// The nearest lattice point to a direction; nothing is asked of its length but that it is finite
/// and not zero.
[[nodiscard]] OctNormal encodeNormal(const glm::dvec3& direction);
/// Unit length.
[[nodiscard]] glm::vec3 decodeNormal(const OctNormal& normal);

/// One channel of a colour. linear: 0 to 1, clamped.
[[nodiscard]] std::uint8_t srgbFromLinear(double linear);

}  // namespace limn
