// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/neighbourhood.h"

#include <array>
#include <cstdint>

/// How likely each way to cut a ring is. A collapse v → u leaves marks on u's ring: the vertices
/// inside the fan were two edges away from u and still are farther off than the rest, l and r were
/// neighbours of both and are near, and the fan took up about as much of u's full turn as v's ring
/// had room. So a cut's odds are a product of factors, one for each of the fan's inner vertices,
/// its two ends, the angle it spans, its length and u's valence after it (a generalised additive
/// model). The factors are universal: fitted once, by gradient descent on the likelihood of all
/// cuts of eight meshes, scans and machine parts; on meshes left out they are as good.
namespace limn::split_syntax {

/// Fans of more edges than this are not made.
inline constexpr std::uint32_t kMaxFanEdges = 24;
inline constexpr std::uint32_t kMaxCuts = kMaxRing * kMaxFanEdges;

namespace cut_factors {

// Binary logarithms of the factors, in 16ths.
inline constexpr std::array<std::int16_t, 16> kLength =
    {0, -28, 14, 26, 24, 6, -15, -32, -57, -90, -110, -123, -135, -140, -140, -140};
inline constexpr std::array<std::int16_t, 16> kValence =
    {0, 0, 0, 1, 17, 20, 19, 5, -7, -28, -50, -78, -110, -110, -110, -110};
// By distance from u relative to the ring's mean: 3/8 of an octave of its square a step.
inline constexpr std::array<std::int16_t, 24> kEnd = {18,  24,  23,  21,  23,  22,  23,  20,
                                                      19,  19,  13,  8,   1,   -8,  -15, -29,
                                                      -33, -44, -48, -48, -48, -52, -80, -80};
inline constexpr std::array<std::int16_t, 24> kInner = {-57, -38, -32, -29, -27, -27, -24, -15,
                                                        -5,  3,   12,  18,  26,  30,  30,  24,
                                                        22,  20,  20,  20,  20,  20,  15,  10};
// By the angle that the fan spans at u, π/16 a step.
inline constexpr std::array<std::int16_t, 24> kAngle = {34, 38,  38,  40,  40,  38,  37,  37,
                                                        35, 35,  33,  26,  27,  24,  18,  3,
                                                        0,  -11, -23, -31, -41, -51, -57, -80};

/// kAngle for every angle that a fan can span: its last entry goes on.
constexpr std::array<std::int16_t, 16 * kMaxFanEdges + 1> makeSpans() {
  std::array<std::int16_t, 16 * kMaxFanEdges + 1> spans{};
  for (std::size_t i = 0; i < spans.size(); ++i)
    spans[i] = kAngle[std::min<std::size_t>(i, kAngle.size() - 1)];
  return spans;
}

inline constexpr std::array<std::int16_t, 16 * kMaxFanEdges + 1> kSpan = makeSpans();

// Angles in 128ths of π with a squared tangent of 2^((i − 32) / 4) and a little more.
inline constexpr std::array<std::uint8_t, 65> kArcTangent = {
    3,  3,  3,  3,  4,  4,  4,  5,  5,  6,  6,  7,  7,  8,  9,  10, 10, 11, 12, 13, 14, 16,
    17, 18, 20, 21, 23, 24, 26, 28, 29, 31, 33, 35, 36, 38, 40, 41, 43, 44, 46, 47, 48, 50,
    51, 52, 53, 54, 54, 55, 56, 57, 57, 58, 58, 59, 59, 60, 60, 60, 61, 61, 61, 61, 62};

// ⌊⌊2^(15 − (i mod 16) / 16) rounded⌋ / 2^(i / 16)⌋, at least 1: odds of a score that is i below
// the best.
constexpr std::array<std::uint16_t, 241> makePowers() {
  constexpr std::array<std::uint16_t, 16> kFirst = {
      32768,
      31379,
      30048,
      28774,
      27554,
      26386,
      25268,
      24196,
      23170,
      22188,
      21247,
      20347,
      19484,
      18658,
      17867,
      17109};
  std::array<std::uint16_t, 241> powers{};
  for (std::size_t i = 0; i < powers.size(); ++i)
    powers[i] = i < 240 ? static_cast<std::uint16_t>(kFirst[i % 16] >> (i / 16)) : std::uint16_t{1};
  return powers;
}

inline constexpr std::array<std::uint16_t, 241> kPowers = makePowers();

inline std::size_t step(std::int32_t value, std::int32_t least, std::int32_t size) {
  return static_cast<std::size_t>(std::clamp((value - least) / size, 0, 23));
}

}  // namespace cut_factors

/// Every cut of the ring that opens both sides, by start and then length, with its odds.
struct CutOdds {
  std::uint32_t count = 0;
  std::uint32_t padded = 0;  // `count` and some that have no odds: a multiple of 8
  std::uint32_t total = 0;   // sum of the odds
  /// Odds (1 to 32,768) << 11 + what the index lacks to 2047, so that the largest number is the
  /// likeliest cut, the first of equals.
  std::array<std::int32_t, kMaxCuts> odds;
};

/// Cuts that start at ring vertex s.
inline std::uint32_t cutsFrom(const Neighbourhood& n, std::uint32_t s) {
  return std::min(n.isPath ? n.size - 1 - s : n.size - 1, kMaxFanEdges);
}

inline RingCut cutAt(const Neighbourhood& n, std::uint32_t index) {
  std::uint32_t s = 0;
  if (!n.isPath) {
    s = index / cutsFrom(n, 0);
    index %= cutsFrom(n, 0);
  }
  for (; index >= cutsFrom(n, s); ++s)
    index -= cutsFrom(n, s);
  return {static_cast<std::uint8_t>(s), static_cast<std::uint8_t>(n.wrap(s + index + 1))};
}

inline void findCutOdds(const Neighbourhood& n, CutOdds& result) {
  namespace f = cut_factors;
  std::int32_t largest = 0;
  for (std::uint32_t i = 0; i < n.size; ++i) {
    const glm::ivec3 a = glm::abs(n.ring[i]);
    largest = std::max({largest, a.x, a.y, a.z});
  }
  // Of 14 bits, so that products of two fit 32.
  const int excess = excessBits(largest, 14);
  std::array<glm::ivec3, kMaxRing + 1> w;
  std::array<std::int32_t, kMaxRing> reach;  // log8 of the squared distance from u
  std::int32_t mean = 0;
  for (std::uint32_t i = 0; i < n.size; ++i) {
    w[i] = n.ring[i] >> excess;
    reach[i] = log8(static_cast<std::uint32_t>(dot32(w[i], w[i])));
    mean += reach[i];
  }
  w[n.size] = w[0];
  mean /= static_cast<std::int32_t>(n.size);
  // Twice around, so that a fan is a range: what a vertex counts for as an end; what those inside
  // before it count for, summed up; and the angles of the ring edges before it as seen from u,
  // in 128ths of π, summed up.
  std::array<std::int32_t, 2 * kMaxRing> end;
  std::array<std::int32_t, 2 * kMaxRing> innerBefore;
  std::array<std::int32_t, 2 * kMaxRing> angleBefore;
  std::int32_t inner = 0;
  std::int32_t angle = 0;
  for (std::uint32_t i = 0; i < n.size; ++i) {
    const std::size_t step = f::step(reach[i] - mean, -32, 3);
    end[i] = end[i + n.size] = f::kEnd[step];
    innerBefore[i] = inner;
    angleBefore[i] = angle;
    inner += f::kInner[step];
    const glm::ivec3& a = w[i];
    const glm::ivec3& b = w[i + 1];
    const Wide area(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    const std::int32_t along = dot32(a, b);
    const std::int32_t tangent = log8(static_cast<std::uint64_t>(dot(area, area))) -
                                 2 * log8(static_cast<std::uint32_t>(std::abs(along)));
    const std::int32_t acute =
        f::kArcTangent[static_cast<std::size_t>((std::clamp(tangent, -64, 64) + 64) / 2)];
    angle += along >= 0 ? acute : 128 - acute;
  }
  for (std::uint32_t i = 0; i < n.size; ++i) {
    innerBefore[i + n.size] = innerBefore[i] + inner;
    angleBefore[i + n.size] = angleBefore[i] + angle;
  }
  // What the far end of a fan counts for together with all inside before it.
  std::array<std::int32_t, 2 * kMaxRing> far;
  for (std::uint32_t i = 0; i < 2 * n.size; ++i)
    far[i] = end[i] + innerBefore[i];
  std::array<std::int32_t, kMaxFanEdges + 1> shape;  // what the length counts for
  for (std::uint32_t length = 1; length <= std::min(n.size, kMaxFanEdges); ++length) {
    shape[length] =
        f::kLength[std::min(length, 15U)] + f::kValence[std::min(n.size + 2 - length, 15U)];
  }

  std::array<std::int32_t, kMaxCuts> scores;
  std::int32_t best = -(1 << 20);
  std::uint32_t count = 0;
  for (std::uint32_t s = 0; s < n.size; ++s) {
    const std::uint32_t most = cutsFrom(n, s);
    const std::int32_t near = end[s] - innerBefore[s + 1];
    for (std::uint32_t length = 1; length <= most; ++length) {
      const auto span = static_cast<std::uint32_t>(angleBefore[s + length] - angleBefore[s]);
      const std::int32_t score = near + far[s + length] + shape[length] + f::kSpan[span / 8];
      scores[count++] = score;
      best = std::max(best, score);
    }
  }
  result.count = count;
  result.total = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t odds =
        f::kPowers[static_cast<std::size_t>(std::min(best - scores[i], 240))];
    result.odds[i] = static_cast<std::int32_t>(odds << 11 | (2047 - i));
    result.total += odds;
  }
  result.padded = (count + 7) / 8 * 8;
  std::fill(result.odds.begin() + count, result.odds.begin() + result.padded, 0);
}

}  // namespace limn::split_syntax
