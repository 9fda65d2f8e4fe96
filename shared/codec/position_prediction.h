// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/neighbourhood.h"

#include <algorithm>
#include <array>
#include <cstdint>

/// Where a split's vertex is expected, and how far off that may be (SPEC.md, "A run": a client in
/// another language computes the same numbers). Integers alone, so that every platform agrees: all
/// lengths in grid units or their 16ths, relative to the parent u; coordinates within
/// kMaxGridCoordinate keep every product within 64 bits. Nothing here fails.
/// Threads: reentrant. Cost: O(ring), about 0.16 µs a split.
namespace limn::split_syntax {

/// Terms that correct the mean of the fan, and their weights in 256ths by length of the fan.
inline constexpr std::uint32_t kTerms = 8;
inline constexpr std::uint32_t kWeightClasses = 6;
using Weights = std::array<std::array<std::int16_t, kTerms>, kWeightClasses>;

/// What a split's vertex is predicted from; predictedOffset() weighs it.
struct Prediction {
  Wide fan{0};  // mean of the fan's ring vertices, relative to u, in 16ths
  /// In 16ths: to u; to the fan's ends; to the whole ring; to the centroids of perimeter and area
  /// of the polygon u, fan; then what makes up for curvature, along the normals of the ring (its
  /// mean) and of the fan (its mean, its ends less its mean).
  std::array<Wide, kTerms> terms{};
  std::uint32_t weightClass = 0;
  Wide normal{0};           // of the fan; of the ring where that has none; 15 bits
  int normalAxis = 0;       // axis along which it is longest
  std::int32_t reach8 = 0;  // log8 of the fan vertices' mean distance from u (sum norm)
};

/// The part of `a` along `normal` (15 bits; zero: none).
inline Wide partAlong(const Wide& a, const Wide& normal, std::int64_t normalSquared) {
  if (normalSquared == 0) return Wide(0);
  return scaled(normal, (dot(a, normal) << 12) / normalSquared, 12);
}

/// sum / count for 1 to kMaxRing addends of at most 25 bits.
inline Wide meanOf(const Wide& sum, std::uint32_t count) {
  return scaled(sum, (1 << 24) / static_cast<std::int64_t>(count), 24);
}

/// n: at least one ring vertex. fan: of that ring, not empty.
inline Prediction predict(const Neighbourhood& n, const Fan& fan) {
  constexpr std::int64_t kFine = 16;
  const auto count = static_cast<std::int64_t>(fan.count);
  Wide ringSum(0);
  Wide ringNormal(0);
  for (std::uint32_t i = 0; i < n.size; ++i) {
    const Wide a(n.ring[i]);
    ringSum += a;
    if (i < n.edges()) ringNormal += cross(a, Wide(n.ring[n.wrap(i + 1)]));
  }
  Wide fanSum(0);
  Wide fanNormal(0);
  std::int64_t reach = 0;
  // Of each edge of the polygon u, fan: its length, and the area of the triangle with u; sum norms.
  std::array<std::int64_t, kMaxRing + 1> lengths;
  std::array<std::int64_t, kMaxRing + 1> areas;
  std::int64_t most = 0;
  std::int64_t largest = 0;
  Wide before(0);
  for (std::uint32_t k = 0; k <= fan.count; ++k) {
    const Wide a = k == fan.count ? Wide(0) : Wide(n.ring[n.wrap(fan.first + k)]);
    const Wide area = cross(before, a);
    fanSum += a;
    fanNormal += area;
    reach += sumNorm(a);
    lengths[k] = sumNorm(a - before);
    areas[k] = sumNorm(area);
    most = std::max(most, lengths[k]);
    largest = std::max(largest, areas[k]);
    before = a;
  }
  // Twice and three times the centroids, the weights cut down to 12 bits.
  const int excessLength = excessBits(most, 12);
  const int excessArea = excessBits(largest, 12);
  Wide perimeter(0);
  Wide centroid(0);
  std::int64_t length = 0;
  std::int64_t area = 0;
  before = Wide(0);
  for (std::uint32_t k = 0; k <= fan.count; ++k) {
    const Wide a = k == fan.count ? Wide(0) : Wide(n.ring[n.wrap(fan.first + k)]);
    lengths[k] >>= excessLength;
    areas[k] >>= excessArea;
    perimeter += lengths[k] * (a + before);
    centroid += areas[k] * (a + before);
    length += lengths[k];
    area += areas[k];
    before = a;
  }

  Prediction p;
  const Wide first(n.ring[fan.first]);
  const Wide last(n.ring[n.wrap(fan.first + fan.count - 1)]);
  p.fan = meanOf(kFine * fanSum, fan.count);
  const Wide ring = meanOf(kFine * ringSum, n.size);
  const Wide ends = kFine / 2 * (first + last);
  ringNormal = shifted(ringNormal, excessBits(maxNorm(ringNormal), 15));
  p.normal = shifted(fanNormal, excessBits(maxNorm(fanNormal), 15));
  if (p.normal == Wide(0)) p.normal = ringNormal;
  const std::int64_t normalSquared = dot(p.normal, p.normal);
  p.terms[0] = -p.fan;
  p.terms[1] = ends - p.fan;
  p.terms[2] = ring - p.fan;
  constexpr std::int64_t kOne = std::int64_t{1} << 32;
  if (length > 0) p.terms[3] = scaled(perimeter, kOne / (2 * length), 28) - p.fan;
  if (area > 0) p.terms[4] = scaled(centroid, kOne / (3 * area), 28) - p.fan;
  p.terms[5] = partAlong(ring, ringNormal, dot(ringNormal, ringNormal));
  p.terms[6] = partAlong(p.fan, p.normal, normalSquared);
  p.terms[7] = partAlong(ends - p.fan, p.normal, normalSquared);
  p.weightClass = std::min(fan.count, kWeightClasses) - 1;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(p.normal[axis]) > std::abs(p.normal[p.normalAxis])) p.normalAxis = axis;
  }
  p.reach8 = log8(static_cast<std::uint64_t>(reach / count));
  return p;
}

/// `start`, and the terms as they weigh, in whole units. The former in 16ths, as they are.
template <std::size_t N>
Wide weighed(
    const Wide& start,
    const std::array<Wide, N>& terms,
    const std::array<std::int16_t, N>& weights) {
  Wide sum = std::int64_t{256} * start;
  for (std::size_t t = 0; t < N; ++t)
    sum += std::int64_t{weights[t]} * terms[t];
  return scaled(sum, 1, 12);
}

/// Predicted offset of v from u, grid units, rounded.
inline Wide predictedOffset(const Prediction& p, const Weights& weights) {
  return weighed(p.fan, p.terms, weights[p.weightClass]);
}

// ---- Where the parent goes, when a split moves it
// ------------------------------------------------

/// Terms of its displacement, and their weights in 256ths by length of the fan.
inline constexpr std::uint32_t kMoveTerms = kTerms + 4;
using MoveWeights = std::array<std::array<std::int16_t, kMoveTerms>, kWeightClasses>;

/// What the parent's displacement is predicted from: of forests with Placement::kVolume alone.
struct MovePrediction {
  /// In 16ths: those of the vertex's prediction, the mean of the fan, what the vertex is off the
  /// parent, the part of that along the fan's normal, and the way to the plane along the ring's.
  std::array<Wide, kMoveTerms> terms{};
  /// The plane area · x = −swept that x, the displacement, is in or near when the split and its
  /// collapse enclose the same volume; zero: unknown. 15 bits.
  Wide area{0};
  std::int64_t swept = 0;
  std::uint32_t distanceClass = 0;  // of the way to the plane: twice the logarithm, 0 below 1/2
};

/// n: a cycle. p: of the same n and fan. position: the new vertex's, on the grid.
inline MovePrediction predictMove(
    const Neighbourhood& n,
    const Fan& fan,
    const Prediction& p,
    const glm::ivec3& position) {
  constexpr std::int64_t kFine = 16;
  constexpr std::int64_t kFarthest = std::int64_t{1} << 26;
  MovePrediction move;
  const Wide off(position - n.parent);
  std::copy(p.terms.begin(), p.terms.end(), move.terms.begin());
  move.terms[kTerms] = p.fan;
  move.terms[kTerms + 1] = kFine * off;
  move.terms[kTerms + 2] = partAlong(kFine * off, p.normal, dot(p.normal, p.normal));

  // Of the tetrahedra over the edges of the ring, those of the fan have the new vertex for a tip
  // instead of the parent, and those of the rest the parent where it goes. So do those over the two
  // edges from the new vertex to the ends of the fan.
  Wide fanArea(0);
  Wide ringArea(0);
  const Wide first(n.ring[fan.first]);
  const Wide last(n.ring[n.wrap(fan.first + fan.count - 1)]);
  for (std::uint32_t k = 0; k < n.size; ++k) {
    const std::uint32_t i = n.wrap(fan.first + k);
    const Wide area = cross(Wide(n.ring[i]), Wide(n.ring[n.wrap(i + 1)]));
    ringArea += area;
    if (k + 1 < fan.count) fanArea += area;
  }
  move.area = ringArea - fanArea + cross(first, off) + cross(off, last);
  const int excess =
      excessBits(std::max({maxNorm(fanArea), maxNorm(ringArea), maxNorm(move.area)}), 15);
  move.area = shifted(move.area, excess);
  move.swept = dot(shifted(fanArea, excess), off);
  ringArea = shifted(ringArea, excess);
  const std::int64_t along = dot(move.area, ringArea);
  if (along > 0) {
    Wide& way = move.terms[kTerms + 3];
    for (int axis = 0; axis < 3; ++axis) {
      way[axis] = std::clamp(
          roundedQuotient(-kFine * move.swept * ringArea[axis], along),
          -kFarthest,
          kFarthest);
    }
    const std::int32_t distance = log8(static_cast<std::uint64_t>(maxNorm(way)));
    move.distanceClass = static_cast<std::uint32_t>(std::max(distance - 24, 0)) / 4;
  }
  return move;
}

}  // namespace limn::split_syntax
