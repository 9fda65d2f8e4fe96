// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/progressive/split_forest.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

/// What a split is predicted from, in integers, so that every platform agrees.
namespace limn::split_syntax {

inline constexpr std::uint32_t kMaxRing = 64;

using Wide = glm::vec<3, std::int64_t>;

/// The parent u of a split and its canonical ring. Coordinates are at most kMaxGridCoordinate.
struct Neighbourhood {
  glm::ivec3 parent{0};
  std::uint32_t size = 0;
  bool isPath = false;                    // the parent is on a border
  std::array<glm::ivec3, kMaxRing> ring;  // relative to the parent

  [[nodiscard]] std::uint32_t wrap(std::uint32_t i) const { return i >= size ? i - size : i; }

  /// Ring edges: pairs of vertices i and wrap(i + 1) that are joined.
  [[nodiscard]] std::uint32_t edges() const { return isPath ? size - 1 : size; }
};

/// What a forest knows of split v, all as it stands before v's level.
inline Neighbourhood neighbourhoodOf(const SplitForest& forest, VertexId v) {
  Neighbourhood n;
  const auto ring = forest.ring(v);
  const VertexId end = forest.placement() == Placement::kSubset
                           ? forest.vertexCount()
                           : forest.levelBegin[forest.levelOf(v)];
  n.parent = forest.positionIn(end, forest.parent(v));
  n.size = static_cast<std::uint32_t>(std::min<std::size_t>(ring.size(), kMaxRing));
  for (std::uint32_t i = 0; i < n.size; ++i)
    n.ring[i] = forest.positionIn(end, ring[i]) - n.parent;
  n.isPath = (forest.features[v - forest.baseVertexCount()] & kSplitParentOnBorder) != 0;
  return n;
}

/// The vertices first, wrap(first + 1), … of the ring that a cut gives to the new vertex.
struct Fan {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

inline Fan fanOf(const Neighbourhood& n, const RingCut& cut) {
  const std::uint32_t first = cut.left == RingCut::kNoCut ? 0 : cut.left;
  const std::uint32_t last = cut.right == RingCut::kNoCut ? n.size - 1 : cut.right;
  return {first, (n.isPath ? last - first : n.wrap(last + n.size - first)) + 1};
}

/// Eight times the binary logarithm, the fraction linear between powers of two; −8 for 0.
inline std::int32_t log8(std::uint64_t x) {
  const int top = std::bit_width(x | 1) - 1;
  const auto fraction = static_cast<std::int32_t>(x << (63 - top) >> 60 & 7);
  return 8 * top + fraction - (x == 0 ? 8 : 0);
}

inline std::int64_t dot(const Wide& a, const Wide& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Of coordinates of at most 14 bits.
inline std::int32_t dot32(const glm::ivec3& a, const glm::ivec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline Wide cross(const Wide& a, const Wide& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline std::int64_t sumNorm(const Wide& a) {
  return std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
}

inline std::int64_t maxNorm(const Wide& a) {
  return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
}

/// How far right a vector must be shifted (arithmetically) to fit `bits` bits, sign apart.
inline int excessBits(std::int64_t largest, int bits) {
  return std::max(0, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(largest))) - bits);
}

inline Wide shifted(const Wide& a, int by) {
  return {a.x >> by, a.y >> by, a.z >> by};
}

/// a / b rounded, halves away from zero. b > 0.
inline std::int64_t roundedQuotient(std::int64_t a, std::int64_t b) {
  return a >= 0 ? (a + b / 2) / b : -((-a + b / 2) / b);
}

/// a · factor / 2^shift, rounded downwards after half a step: what divides many numbers by one.
inline Wide scaled(const Wide& a, std::int64_t factor, int shift) {
  const std::int64_t half = std::int64_t{1} << (shift - 1);
  return {
      (a.x * factor + half) >> shift,
      (a.y * factor + half) >> shift,
      (a.z * factor + half) >> shift};
}

}  // namespace limn::split_syntax
