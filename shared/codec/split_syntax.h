// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/progressive/vertex_split.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <span>

/// The split coder's syntax, written once for encoder, decoder and trainer (see bin_coder.h).
/// protocol/SPEC.md, "Split coding", is its specification. All arithmetic is on integers, so that
/// every platform agrees.
namespace limn::split_syntax {

inline constexpr std::uint32_t kMaxRing = 64;

// ---- Contexts ----------------------------------------------------------------------------------

inline constexpr std::uint32_t kMagnitudeBins = 20;  // unary bins of a number's bit length
/// A number ≥ 0 takes kNumberContexts contexts: its bit length in unary, then the bit below the
/// top.
inline constexpr std::uint32_t kNumberContexts = 2 * kMagnitudeBins;
inline constexpr std::uint32_t kScales = 40;

inline constexpr std::uint32_t kRaw = 0;    // an even bit
inline constexpr std::uint32_t kIdGap = 1;  // by last gap's class
inline constexpr std::uint32_t kParentGap =
    kIdGap + 3 * kNumberContexts;  // by this gap's and last class
inline constexpr std::uint32_t kFirstParent = kParentGap + 16 * kNumberContexts;
inline constexpr std::uint32_t kOpenSide =
    kFirstParent + kNumberContexts;                              // left missing, right missing
inline constexpr std::uint32_t kFanLength = kOpenSide + 2;       // by ring size, position
inline constexpr std::uint32_t kFanRank = kFanLength + 16 * 16;  // by ring size, rank
inline constexpr std::uint32_t kFeatures = kFanRank + 16 * 8;    // any; then the five edges
inline constexpr std::uint32_t kResidual = kFeatures + 6;        // by scale, axis
inline constexpr std::uint32_t kContexts = kResidual + kScales * 2 * kNumberContexts;

// ---- Numbers -----------------------------------------------------------------------------------

/// A number ≥ 0: the bit length of value + 1 − 1 in unary, then the bits below the top one, the
/// first in a context. Numbers up to 2^31 − 2.
template <class Bins>
std::uint32_t codeNumber(Bins& bins, std::uint32_t context, std::uint32_t value) {
  const auto bits = static_cast<std::uint32_t>(std::bit_width(value + 1)) - 1;
  std::uint32_t length = 0;
  while (length < 31 && bins.code(context + std::min(length, kMagnitudeBins - 1), length < bits))
    ++length;
  std::uint32_t result = 1;
  for (std::uint32_t i = length; i-- > 0;) {
    const bool first = i + 1 == length;
    const std::uint32_t bitContext =
        first ? context + kMagnitudeBins + std::min(length, kMagnitudeBins - 1) : kRaw;
    result = result << 1 | (bins.code(bitContext, ((value + 1) >> i & 1) != 0) ? 1 : 0);
  }
  return result - 1;
}

/// A signed number: magnitude, then the sign of what is not zero.
template <class Bins>
std::int32_t codeSigned(Bins& bins, std::uint32_t context, std::int32_t value) {
  const auto magnitude = static_cast<std::int32_t>(
      codeNumber(bins, context, static_cast<std::uint32_t>(std::abs(value))));
  if (magnitude == 0) return 0;
  return bins.code(kRaw, value < 0) ? -magnitude : magnitude;
}

inline std::uint32_t numberClass(std::uint32_t value) {
  return std::min<std::uint32_t>(static_cast<std::uint32_t>(std::bit_width(value)), 3);
}

// ---- Names: which splits a run carries ----------------------------------------------------------

/// Splits come sorted by id. Within a level, parents run upwards with the ids.
struct NameState {
  VertexId nextId = 0;      // the smallest id that the next split can have
  VertexId nextParent = 0;  // the smallest parent that split can have
  std::uint32_t level = 0;
  std::uint32_t lastIdClass = 0;
  std::uint32_t lastParentClass = 0;
};

/// vertex, parent: in and out. contiguous: ids have no gaps and are not coded.
/// levelOfVertex(id): level of a vertex; levelBegin[level]: its first vertex.
template <class Bins>
void codeName(
    Bins& bins,
    NameState& state,
    std::span<const std::uint32_t> levelBegin,
    bool contiguous,
    VertexId& vertex,
    VertexId& parent) {
  std::uint32_t gap = 0;
  if (!contiguous) {
    gap = codeNumber(
        bins,
        kIdGap + std::min(state.lastIdClass, 2U) * kNumberContexts,
        vertex - state.nextId);
  }
  // Saturating: a hostile gap must not wrap around into a valid id.
  const std::uint64_t id = static_cast<std::uint64_t>(state.nextId) + gap;
  vertex = static_cast<VertexId>(std::min<std::uint64_t>(id, kNone));
  const std::uint32_t level = limn::levelOf(levelBegin, vertex);
  std::uint64_t least = 0;
  std::uint32_t context = kFirstParent;
  if (level == state.level) {
    least =
        static_cast<std::uint64_t>(state.nextParent) + gap;  // each skipped split has a parent too
    context = kParentGap + (4 * numberClass(gap) + state.lastParentClass) * kNumberContexts;
  } else if (level < levelBegin.size()) {
    least = vertex - levelBegin[level];
    state.lastParentClass = 0;
  }
  const std::uint32_t parentGap =
      codeNumber(bins, context, static_cast<std::uint32_t>(parent - least));
  parent = static_cast<VertexId>(std::min<std::uint64_t>(least + parentGap, kNone));
  state.lastIdClass = numberClass(gap);
  if (level == state.level) state.lastParentClass = numberClass(parentGap);
  state.level = level;
  state.nextId = vertex == kNone ? kNone : vertex + 1;
  state.nextParent = parent == kNone ? kNone : parent + 1;
}

// ---- Cut: where the parent's ring opens ---------------------------------------------------------

/// The parent, its canonical ring, and where they are.
struct Neighbourhood {
  glm::ivec3 parent{0};
  std::uint32_t size = 0;
  std::array<glm::ivec3, kMaxRing> ring;
  bool isPath = false;  // the parent is on a border

  [[nodiscard]] std::uint32_t wrap(std::uint32_t i) const { return i >= size ? i - size : i; }
};

/// Twice the area of a ring triangle at the parent, in the sum norm: cheap, and enough to rank by.
inline std::int64_t ringTriangleSize(const Neighbourhood& n, std::uint32_t i) {
  using Wide = glm::vec<3, std::int64_t>;
  const Wide a = Wide(n.ring[i]) - Wide(n.parent);
  const Wide b = Wide(n.ring[n.wrap(i + 1)]) - Wide(n.parent);
  return std::abs(a.y * b.z - a.z * b.y) + std::abs(a.z * b.x - a.x * b.z) +
         std::abs(a.x * b.y - a.y * b.x);
}

/// Possible starts of a fan of `length` ring edges, the most likely first: a removed vertex leaves
/// large triangles behind.
inline std::uint32_t rankStarts(
    const Neighbourhood& n,
    std::uint32_t length,
    std::array<std::uint8_t, kMaxRing>& order) {
  const std::uint32_t edges = n.isPath ? n.size - 1 : n.size;
  const std::uint32_t starts = n.isPath ? n.size - length : n.size;
  std::array<std::int64_t, kMaxRing> sizes{};
  for (std::uint32_t i = 0; i < edges; ++i)
    sizes[i] = ringTriangleSize(n, i);
  std::array<std::int64_t, kMaxRing> sums{};
  for (std::uint32_t s = 0; s < starts; ++s) {
    sums[s] = 0;
    for (std::uint32_t i = 0; i < length; ++i)
      sums[s] += sizes[n.isPath ? s + i : n.wrap(s + i)];
    std::uint32_t at = s;
    for (; at > 0 && sums[order[at - 1]] < sums[s]; --at)
      order[at] = order[at - 1];
    order[at] = static_cast<std::uint8_t>(s);
  }
  return starts;
}

/// cut: in and out. Returns false when no cut fits (only damaged bytes get there).
template <class Bins>
bool codeCut(Bins& bins, const Neighbourhood& n, RingCut& cut) {
  bool noLeft = false;
  bool noRight = false;
  if (n.isPath) {
    noLeft = bins.code(kOpenSide, cut.left == RingCut::kNoCut);
    if (!noLeft) noRight = bins.code(kOpenSide + 1, cut.right == RingCut::kNoCut);
  }
  const std::uint32_t most = n.size - 1;  // ring edges in a fan, at most
  const std::uint32_t least = noLeft || noRight ? 0 : 1;
  if (most < least) return false;
  std::uint32_t actual = 0;
  if (noLeft) {
    actual = cut.right;
  } else if (noRight) {
    actual = most - cut.left;
  } else {
    actual = n.wrap(cut.right + n.size - cut.left);
  }
  const std::uint32_t sizeClass = std::min(n.size, 15U);
  std::uint32_t length = least;
  while (length < most &&
         bins.code(kFanLength + 16 * sizeClass + std::min(length, 15U), actual > length)) {
    ++length;
  }
  if (noLeft) {
    cut = {RingCut::kNoCut, static_cast<std::uint8_t>(length)};
    return true;
  }
  if (noRight) {
    cut = {static_cast<std::uint8_t>(most - length), RingCut::kNoCut};
    return true;
  }
  std::array<std::uint8_t, kMaxRing> order{};
  const std::uint32_t starts = rankStarts(n, length, order);
  std::uint32_t rank = 0;
  while (rank + 1 < starts &&
         bins.code(kFanRank + 8 * sizeClass + std::min(rank, 7U), order[rank] != cut.left)) {
    ++rank;
  }
  cut.left = order[rank];
  cut.right = static_cast<std::uint8_t>(n.wrap(cut.left + length));
  return true;
}

// ---- Position -----------------------------------------------------------------------------------

/// Weights, in 256ths, of the three terms that correct the fan's mean, by length of the fan.
inline constexpr std::uint32_t kWeightClasses = 6;
using Weights = std::array<std::array<std::int16_t, 3>, kWeightClasses>;

/// What a position is predicted from: the neighbours that v will have, and the rest of the ring.
struct Prediction {
  std::array<glm::vec<3, std::int64_t>, 4>
      terms;  // fan's mean; u, sides' mean, ring's mean less it; ·16
  std::uint32_t weightClass = 0;
  std::uint32_t scale = 0;  // context of the residual
  int normalAxis = 0;       // axis that the fan faces most
  glm::vec<3, std::int64_t> normal{0};
};

inline std::int64_t roundedQuotient(std::int64_t a, std::int64_t b) {
  // b > 0; halves away from zero.
  return a >= 0 ? (a + b / 2) / b : -((-a + b / 2) / b);
}

inline Prediction predict(const Neighbourhood& n, const RingCut& cut) {
  using Wide = glm::vec<3, std::int64_t>;
  constexpr std::int64_t kFine = 16;
  const std::uint32_t first = cut.left == RingCut::kNoCut ? 0 : cut.left;
  const std::uint32_t last = cut.right == RingCut::kNoCut ? n.size - 1 : cut.right;
  const std::uint32_t count = (n.isPath ? last - first : n.wrap(last + n.size - first)) + 1;
  const Wide parent(n.parent);

  Wide fan(0);
  Wide all(0);
  Wide normal(0);
  std::int64_t reach = 0;
  for (std::uint32_t i = 0; i < n.size; ++i)
    all += Wide(n.ring[i]) - parent;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t i = n.isPath ? first + k : n.wrap(first + k);
    const Wide a = Wide(n.ring[i]) - parent;
    fan += a;
    reach += std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
    if (k + 1 < count) {
      const Wide b = Wide(n.ring[n.isPath ? i + 1 : n.wrap(i + 1)]) - parent;
      normal += Wide(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    }
  }
  const Wide sides = Wide(n.ring[first]) + Wide(n.ring[last]) - parent - parent;
  const auto mean = [](const Wide& sum, std::int64_t by) {
    return Wide(
        roundedQuotient(kFine * sum.x, by),
        roundedQuotient(kFine * sum.y, by),
        roundedQuotient(kFine * sum.z, by));
  };
  Prediction p;
  p.terms[0] = mean(fan, count);
  p.terms[1] = -p.terms[0];
  p.terms[2] = mean(sides, 2) - p.terms[0];
  p.terms[3] = mean(all, n.size) - p.terms[0];
  p.weightClass = std::min(count, kWeightClasses) - 1;
  // Half steps of the binary logarithm of the mean reach.
  const auto size = static_cast<std::uint64_t>(reach / count);
  const auto width = static_cast<std::uint32_t>(std::bit_width(size));
  const std::uint32_t half = width >= 2 ? static_cast<std::uint32_t>(size >> (width - 2) & 1) : 0;
  p.scale = std::min(2 * width + half, kScales - 1);
  // Only its direction counts: 30 bits keep later products within 64.
  std::int64_t largest = 0;
  for (int axis = 0; axis < 3; ++axis)
    largest = std::max(largest, std::abs(normal[axis]));
  const int excess =
      std::max(0, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(largest))) - 30);
  for (int axis = 0; axis < 3; ++axis)
    p.normal[axis] = normal[axis] >> excess;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(p.normal[axis]) > std::abs(p.normal[p.normalAxis])) p.normalAxis = axis;
  }
  return p;
}

/// Predicted offset of v from u.
inline glm::vec<3, std::int64_t> predictedOffset(const Prediction& p, const Weights& weights) {
  glm::vec<3, std::int64_t> sum = std::int64_t{256} * p.terms[0];
  for (int i = 0; i < 3; ++i)
    sum += std::int64_t{weights[p.weightClass][i]} * p.terms[i + 1];
  constexpr std::int64_t kUnit = 256 * 16;
  return {
      roundedQuotient(sum.x, kUnit),
      roundedQuotient(sum.y, kUnit),
      roundedQuotient(sum.z, kUnit)};
}

/// position: in and out. The two axes along the surface come first; the third is then corrected to
/// stay in the fan's plane, which takes the place of a rotated frame without leaving the grid.
template <class Bins>
void codePosition(
    Bins& bins,
    const Neighbourhood& n,
    const Prediction& p,
    const Weights& weights,
    glm::ivec3& position) {
  const auto offset = predictedOffset(p, weights);
  const int axes[3] = {(p.normalAxis + 1) % 3, (p.normalAxis + 2) % 3, p.normalAxis};
  std::array<std::int64_t, 2> residuals{};
  glm::ivec3 result(0);
  for (int i = 0; i < 3; ++i) {
    const int axis = axes[i];
    std::int64_t expected = n.parent[axis] + offset[axis];
    if (i == 2 && p.normal[axis] != 0) {
      const std::int64_t sign = p.normal[axis] > 0 ? 1 : -1;
      // Residuals are clamped so that damaged bytes cannot overflow the products.
      constexpr std::int64_t kFar = 1 << 20;
      const std::int64_t drift = p.normal[axes[0]] * std::clamp(residuals[0], -kFar, kFar) +
                                 p.normal[axes[1]] * std::clamp(residuals[1], -kFar, kFar);
      expected -= roundedQuotient(sign * drift, sign * p.normal[axis]);
    }
    const std::uint32_t context = kResidual + (2 * p.scale + (i == 2 ? 1 : 0)) * kNumberContexts;
    const std::int32_t residual =
        codeSigned(bins, context, static_cast<std::int32_t>(position[axis] - expected));
    if (i < 2) residuals[static_cast<std::size_t>(i)] = residual;
    result[axis] = static_cast<std::int32_t>(expected + residual);
  }
  position = result;
}

// ---- Features -----------------------------------------------------------------------------------

template <class Bins>
std::uint8_t codeFeatures(Bins& bins, std::uint8_t features) {
  constexpr std::uint8_t kCoded =
      kSplitEdgeUV | kSplitEdgeUL | kSplitEdgeVL | kSplitEdgeUR | kSplitEdgeVR;
  if (!bins.code(kFeatures, (features & kCoded) != 0)) return 0;
  std::uint8_t result = 0;
  for (std::uint32_t i = 0; i < 5; ++i) {
    if (bins.code(kFeatures + 1 + i, (features >> i & 1) != 0))
      result |= static_cast<std::uint8_t>(1U << i);
  }
  return result;
}

}  // namespace limn::split_syntax
