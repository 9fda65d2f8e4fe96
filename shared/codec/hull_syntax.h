// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"
#include "shared/progressive/progressive_hull.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

/// The syntax of hull splits, written once for encoder and decoder (see adaptive_bins.h).
/// protocol/SPEC.md, "Hull splits", is its specification. All arithmetic is on integers.
namespace limn::hull_syntax {

using Wide = glm::vec<3, std::int64_t>;

inline constexpr std::uint32_t kMaxRing = 64;

inline constexpr std::uint32_t kLengthBins = 24;  // unary bins of a number's bit length
inline constexpr std::uint32_t kNumberContexts = 2 * kLengthBins;
inline constexpr std::uint32_t kScales = 24;

inline constexpr std::uint32_t kRaw = 0;  // an even bit; its probability never changes
inline constexpr std::uint32_t kAge = 1;
inline constexpr std::uint32_t kFanLength = kAge + kNumberContexts;  // by ring size, length so far
inline constexpr std::uint32_t kFanRank = kFanLength + 16 * 16;      // by rank so far
inline constexpr std::uint32_t kStays = kFanRank + 16;
inline constexpr std::uint32_t kResidual = kStays + 1;  // by scale, vertex, axis
inline constexpr std::uint32_t kContexts = kResidual + kScales * 4 * kNumberContexts;

/// A number ≥ 0, at most 2^31 − 2: the bit length of value + 1, less 1, in unary, then the bits
/// below the top one, the first in a context.
template <class Bins>
std::uint32_t codeNumber(Bins& bins, std::uint32_t context, std::uint32_t value) {
  const auto bits = static_cast<std::uint32_t>(std::bit_width(value + 1)) - 1;
  std::uint32_t length = 0;
  while (length < 30 && bins.code(context + std::min(length, kLengthBins - 1), length < bits))
    ++length;
  std::uint32_t result = 1;
  for (std::uint32_t i = length; i-- > 0;) {
    const std::uint32_t bin =
        i + 1 == length ? context + kLengthBins + std::min(length, kLengthBins - 1) : kRaw;
    result = result << 1 | (bins.code(bin, ((value + 1) >> i & 1) != 0) ? 1 : 0);
  }
  return result - 1;
}

template <class Bins>
std::int32_t codeSigned(Bins& bins, std::uint32_t context, std::int32_t value) {
  const auto magnitude = static_cast<std::int32_t>(
      codeNumber(bins, context, static_cast<std::uint32_t>(std::abs(value))));
  if (magnitude == 0) return 0;
  return bins.code(kRaw, value < 0) ? -magnitude : magnitude;
}

/// The ring of a vertex, counter-clockwise, from its smallest vertex on.
inline void
canonicalRing(const HalfEdgeMesh& mesh, std::uint32_t vertex, std::vector<std::uint32_t>& ring) {
  mesh.ring(vertex, ring);
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
}

/// A vertex that splits, and its ring's positions relative to it.
struct Neighbourhood {
  std::uint32_t size = 0;
  std::array<Wide, kMaxRing> ring;

  [[nodiscard]] std::uint32_t wrap(std::uint32_t i) const { return i >= size ? i - size : i; }
};

/// Starts of a fan of `length` ring edges, the one with the largest triangles first.
inline void rankStarts(
    const Neighbourhood& n,
    std::uint32_t length,
    std::array<std::uint32_t, kMaxRing>& order) {
  std::array<std::int64_t, kMaxRing> sizes{};
  for (std::uint32_t i = 0; i < n.size; ++i) {
    const Wide& a = n.ring[i];
    const Wide& b = n.ring[n.wrap(i + 1)];
    sizes[i] = std::abs(a.y * b.z - a.z * b.y) + std::abs(a.z * b.x - a.x * b.z) +
               std::abs(a.x * b.y - a.y * b.x);
  }
  std::array<std::int64_t, kMaxRing> sums{};
  for (std::uint32_t s = 0; s < n.size; ++s) {
    for (std::uint32_t i = 0; i < length; ++i)
      sums[s] += sizes[n.wrap(s + i)];
    std::uint32_t at = s;
    for (; at > 0 && sums[order[at - 1]] < sums[s]; --at)
      order[at] = order[at - 1];
    order[at] = s;
  }
}

/// The ring edges from index first counter-clockwise, `length` of them.
struct Fan {
  std::uint32_t first = 0;
  std::uint32_t length = 1;
};

template <class Bins>
Fan codeFan(Bins& bins, const Neighbourhood& n, Fan fan) {
  const std::uint32_t sizeClass = std::min(n.size, 15U);
  std::uint32_t length = 1;
  while (length + 1 < n.size &&
         bins.code(kFanLength + 16 * sizeClass + std::min(length, 15U), length < fan.length))
    ++length;
  std::array<std::uint32_t, kMaxRing> order{};
  rankStarts(n, length, order);
  std::uint32_t rank = 0;
  while (rank + 1 < n.size && bins.code(kFanRank + std::min(rank, 15U), order[rank] != fan.first))
    ++rank;
  return {order[rank], length};
}

/// Of the corners of a fan: what positions are coded against.
struct FanShape {
  Wide sum{0};
  std::int64_t corners = 0;
  std::uint32_t scale = 0;  // context class: half steps of log2 of the mean distance
  int normalAxis = 0;       // that the fan faces most
};

inline FanShape shapeOf(const Neighbourhood& n, const Fan& fan) {
  FanShape shape;
  shape.corners = fan.length + 1;
  Wide normal(0);
  std::int64_t reach = 0;
  for (std::uint32_t i = 0; i <= fan.length; ++i) {
    const Wide& a = n.ring[n.wrap(n.wrap(fan.first) + i)];
    shape.sum += a;
    reach += std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
    if (i == fan.length) break;
    const Wide& b = n.ring[n.wrap(n.wrap(fan.first) + i + 1)];
    normal += Wide(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  }
  const auto mean = static_cast<std::uint64_t>(reach / shape.corners);
  const auto width = static_cast<std::uint32_t>(std::bit_width(mean));
  shape.scale = std::min(width, kScales - 1);
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(normal[axis]) > std::abs(normal[shape.normalAxis])) shape.normalAxis = axis;
  }
  return shape;
}

/// `weight` 256ths of the mean of the fan's corners, rounded towards zero.
inline Wide partOfMean(const FanShape& shape, std::int64_t weight) {
  return shape.sum * weight / (256 * shape.corners);
}

template <class Bins>
glm::ivec3 codeOffset(
    Bins& bins,
    const FanShape& shape,
    std::uint32_t kind,
    const Wide& expected,
    const Wide& offset) {
  glm::ivec3 result(0);
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t context =
        kResidual +
        (4 * shape.scale + 2 * kind + (axis == shape.normalAxis ? 1 : 0)) * kNumberContexts;
    const auto residual = static_cast<std::int32_t>(offset[axis] - expected[axis]);
    // Saturating: damaged bytes must not overflow. Positions are checked by who applies the split.
    const std::int64_t value = expected[axis] + codeSigned(bins, context, residual);
    constexpr std::int64_t kFar = std::int64_t{1} << 24;
    result[axis] = static_cast<std::int32_t>(std::clamp(value, -kFar, kFar));
  }
  return result;
}

/// One split of a hull, in and out. `ring`: scratch. Returns false when the bins make no split of
/// this mesh (only damaged bytes get there).
template <class Bins>
bool codeSplit(
    Bins& bins,
    const HullRefiner& mesh,
    HullSplit& split,
    std::vector<std::uint32_t>& ring) {
  const std::uint32_t vertices = mesh.links().vertexCount();
  const std::uint32_t age = codeNumber(bins, kAge, vertices - 1 - split.vertex);
  if (age >= vertices) return false;
  split.vertex = vertices - 1 - age;
  canonicalRing(mesh.links(), split.vertex, ring);
  if (ring.size() < 3 || ring.size() > kMaxRing) return false;
  Neighbourhood n;
  n.size = static_cast<std::uint32_t>(ring.size());
  const Wide vertex(mesh.positions()[split.vertex]);
  Fan fan;
  for (std::uint32_t i = 0; i < n.size; ++i) {
    n.ring[i] = Wide(mesh.positions()[ring[i]]) - vertex;
    if (ring[i] == split.left) fan.first = i;
  }
  for (std::uint32_t i = 0; i < n.size; ++i) {
    if (ring[i] == split.right) fan.length = n.wrap(i + n.size - fan.first);
  }
  fan = codeFan(bins, n, fan);
  const std::uint32_t last = n.wrap(fan.first + fan.length);
  split.left = ring[fan.first];
  split.right = ring[last];

  // Six tenths of the way to its fan's middle is where the new vertex mostly stands; the other one
  // often stays, and else goes two tenths the same way in return.
  const FanShape added = shapeOf(n, fan);
  const Wide offset = Wide(split.addedPosition) - vertex;
  const glm::ivec3 addedOffset = codeOffset(bins, added, 0, partOfMean(added, 154), offset);
  const Wide keptOffset = Wide(split.keptPosition) - vertex;
  glm::ivec3 kept(0);
  if (!bins.code(kStays, keptOffset == Wide(0))) {
    const FanShape other = shapeOf(n, {last, n.size - fan.length});
    kept = codeOffset(bins, other, 1, Wide(0), keptOffset);
  }
  split.addedPosition = glm::ivec3(vertex) + addedOffset;
  split.keptPosition = glm::ivec3(vertex) + kept;
  return true;
}

}  // namespace limn::hull_syntax
