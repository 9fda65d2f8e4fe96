// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/cut_odds.h"
#include "shared/codec/neighbourhood.h"
#include "shared/codec/position_prediction.h"
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

// ---- Contexts ----------------------------------------------------------------------------------

inline constexpr std::uint32_t kMagnitudeBins = 16;  // unary bins of a number's bit length
/// A number ≥ 0 takes kNumberContexts contexts: its bit length in unary, then the bit below the
/// top.
inline constexpr std::uint32_t kNumberContexts = 2 * kMagnitudeBins;
inline constexpr std::uint32_t kScales = 56;

inline constexpr std::uint32_t kFront = 0;            // by front class
inline constexpr std::uint32_t kIdGap = kFront + 32;  // by class of the last two gaps
inline constexpr std::uint32_t kParentGap = kIdGap + 7 * kNumberContexts;  // by this gap
inline constexpr std::uint32_t kFirstParent = kParentGap + 13 * kNumberContexts;
inline constexpr std::uint32_t kOpenSide =
    kFirstParent + kNumberContexts;                          // left missing, right missing
inline constexpr std::uint32_t kOpenLength = kOpenSide + 2;  // by position
inline constexpr std::uint32_t kCut = kOpenLength + 16;      // by odds
inline constexpr std::uint32_t kFeatures = kCut + 24;        // any; then the five edges
inline constexpr std::uint32_t kResidual = kFeatures + 6;    // by scale, axis
inline constexpr std::uint32_t kMoved = kResidual + kScales * 2 * kNumberContexts;
inline constexpr std::uint32_t kMovedClasses = 16;
inline constexpr std::uint32_t kContexts = kMoved + kMovedClasses;  // kMoved: by how far

// ---- Numbers -----------------------------------------------------------------------------------

template <class Bins>
std::uint32_t codeRawBits(Bins& bins, std::uint32_t count, std::uint32_t value) {
  std::uint32_t result = 0;
  for (std::uint32_t left = count; left > 0;) {
    const std::uint32_t some = std::min(left, 12U);
    left -= some;
    result = result << some | bins.codeRaw(some, value >> left & ((1U << some) - 1));
  }
  return result;
}

/// A number ≥ 0: the bit length of value + 1, less 1, in unary, then the bits below the top one,
/// the first in a context. Numbers up to 2^31 − 2. `tail` more raw bits follow unless it is 0, and
/// come back below the number.
template <class Bins>
std::uint32_t codeNumber(Bins& bins, std::uint32_t context, std::uint32_t value) {
  // An end that has a way of its own with numbers gets them whole.
  if constexpr (requires { bins.codeNumber(context, value); })
    return bins.codeNumber(context, value);
  const auto bits = static_cast<std::uint32_t>(std::bit_width(value + 1)) - 1;
  std::uint32_t length = 0;
  while (length < 31 && bins.code(context + std::min(length, kMagnitudeBins - 1), length < bits))
    ++length;
  if (length == 0) return 0;
  const std::uint32_t top = context + kMagnitudeBins + std::min(length, kMagnitudeBins - 1);
  const std::uint32_t second = bins.code(top, ((value + 1) >> (length - 1) & 1) != 0) ? 3U : 2U;
  const std::uint32_t rest =
      codeRawBits(bins, length - 1, (value + 1) & ((1U << (length - 1)) - 1));
  return (second << (length - 1) | rest) - 1;
}

/// A signed number: magnitude, then the sign of what is not zero.
template <class Bins>
std::int32_t codeSigned(Bins& bins, std::uint32_t context, std::int32_t value) {
  if constexpr (requires { bins.codeSigned(context, value); })
    return bins.codeSigned(context, value);
  const auto magnitude = static_cast<std::int32_t>(
      codeNumber(bins, context, static_cast<std::uint32_t>(std::abs(value))));
  if (magnitude == 0) return 0;
  return bins.codeRaw(1, value < 0 ? 1 : 0) != 0 ? -magnitude : magnitude;
}

inline std::uint32_t numberClass(std::uint32_t value, std::uint32_t most) {
  return std::min(static_cast<std::uint32_t>(std::bit_width(value)), most);
}

// ---- Names: which splits a run carries ----------------------------------------------------------

/// Splits come sorted by id. Within a level, parents run upwards with the ids.
struct NameState {
  VertexId nextId = 0;      // the smallest id that the next split can have
  VertexId nextParent = 0;  // the smallest parent that split can have
  std::uint32_t level = 0;
  std::uint32_t lastGap = 0;  // of ids, and the one before
  std::uint32_t gapBefore = 0;
};

/// A name among any others: gaps in ids and in parents. vertex, parent: in and out.
template <class Bins>
void codeName(
    Bins& bins,
    NameState& state,
    std::span<const std::uint32_t> levelBegin,
    VertexId& vertex,
    VertexId& parent) {
  const std::uint32_t recent = numberClass(
      (2 * std::min(state.lastGap, 1U << 20) + std::min(state.gapBefore, 1U << 20) + 1) / 2,
      6);
  const std::uint32_t gap =
      codeNumber(bins, kIdGap + recent * kNumberContexts, vertex - state.nextId);
  // Saturating: a hostile gap must not wrap around into a valid id.
  const std::uint64_t id = static_cast<std::uint64_t>(state.nextId) + gap;
  vertex = static_cast<VertexId>(std::min<std::uint64_t>(id, kNone));
  // Ids run upwards.
  std::uint32_t level = state.level;
  while (level < levelBegin.size() && levelBegin[level] <= vertex)
    ++level;
  level -= level > 0 ? 1 : 0;
  std::uint64_t least = 0;
  std::uint32_t context = kFirstParent;
  if (level == state.level) {
    // Each skipped split has a parent too.
    least = static_cast<std::uint64_t>(state.nextParent) + gap;
    const std::uint32_t gapClass = gap < 6 ? gap : 4 + numberClass(gap, 8);
    context = kParentGap + gapClass * kNumberContexts;
  } else if (level < levelBegin.size()) {
    least = vertex - levelBegin[level];
  }
  const std::uint32_t parentGap =
      codeNumber(bins, context, static_cast<std::uint32_t>(parent - least));
  parent = static_cast<VertexId>(std::min<std::uint64_t>(least + parentGap, kNone));
  state.gapBefore = state.lastGap;
  state.lastGap = gap;
  state.level = level;
  state.nextId = vertex == kNone ? kNone : vertex + 1;
  state.nextParent = parent == kNone ? kNone : parent + 1;
}

/// A name in a run of consecutive splits of one level, for receivers that hold everything coarser:
/// the next vertex of the front that is a parent, a bit for each that is passed over.
/// front: class of each coarser vertex (front_classes.h). `parent`: in and out; from `first` on.
/// kNone: none of the rest is (damaged bytes).
template <class Bins>
VertexId
codeParent(Bins& bins, std::span<const std::uint8_t> front, VertexId first, VertexId parent) {
  for (VertexId v = first; v < front.size(); ++v) {
    if (bins.code(kFront + front[v], v == parent)) return v;
  }
  return kNone;
}

// ---- Cut: where the parent's ring opens ---------------------------------------------------------

/// cut: in and out. Returns false when no cut fits (only damaged bytes get there).
template <class Bins>
bool codeCut(Bins& bins, const Neighbourhood& n, RingCut& cut) {
  if (n.isPath) {
    const bool noLeft = bins.code(kOpenSide, cut.left == RingCut::kNoCut);
    const bool noRight = !noLeft && bins.code(kOpenSide + 1, cut.right == RingCut::kNoCut);
    if (noLeft || noRight) {
      const std::uint32_t most = n.size - 1;  // ring edges in a fan, at most
      const std::uint32_t actual = noLeft ? cut.right : most - cut.left;
      std::uint32_t length = 0;
      while (length < most && bins.code(kOpenLength + std::min(length, 15U), actual > length))
        ++length;
      cut = noLeft ? RingCut{RingCut::kNoCut, static_cast<std::uint8_t>(length)}
                   : RingCut{static_cast<std::uint8_t>(most - length), RingCut::kNoCut};
      return true;
    }
  }
  CutOdds odds;
  findCutOdds(n, odds);
  if (odds.count == 0) return false;
  // The likeliest first, each with a bit whose context is its odds among those left.
  for (std::uint32_t left = odds.count;; --left) {
    std::int32_t most = 0;
    for (std::uint32_t k = 0; k < odds.padded; ++k)
      most = std::max(most, odds.odds[k]);
    const auto i = static_cast<std::size_t>(2047 - (most & 2047));
    const auto own = static_cast<std::uint32_t>(most >> 11);
    odds.total -= own;
    const RingCut found = cutAt(n, static_cast<std::uint32_t>(i));
    if (left > 1) {
      const std::int32_t ratio = log8(own) - log8(odds.total);
      const auto step = static_cast<std::uint32_t>(std::clamp((ratio + 40) / 4, 0, 23));
      if (!bins.code(kCut + step, found == cut)) {
        odds.odds[i] = 0;
        continue;
      }
    }
    cut = found;
    return true;
  }
}

// ---- Position -----------------------------------------------------------------------------------

/// Context of a residual whose spread goes with 2^(scale8 / 8).
inline std::uint32_t residualContext(std::int32_t scale8, bool across) {
  const auto scale =
      static_cast<std::uint32_t>(std::clamp(scale8 / 3, 0, static_cast<std::int32_t>(kScales) - 1));
  return kResidual + (2 * scale + (across ? 1 : 0)) * kNumberContexts;
}

/// How far off a residual along each of three axes may be, as residualContext() has it; the last
/// axis is the fan normal's longest.
inline std::array<std::int32_t, 3> scalesOf(const Prediction& p, const int (&axes)[3]) {
  // How steep the surface is shortens what can be seen of it along an axis.
  const auto squared = [](std::int64_t a) { return static_cast<std::uint64_t>(a * a); };
  const std::uint64_t all = squared(p.normal.x) + squared(p.normal.y) + squared(p.normal.z);
  const std::int32_t whole = log8(all);
  const std::int32_t first = log8(all - squared(p.normal[axes[0]]));
  const std::int32_t height = log8(squared(p.normal[axes[2]]));
  return {
      p.reach8 + (first - whole) / 2 + 8,
      p.reach8 + (height - first) / 2 + 8,
      p.reach8 + (whole - height) / 2 + 8};
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
  const Wide offset = predictedOffset(p, weights);
  const int axes[3] = {(p.normalAxis + 1) % 3, (p.normalAxis + 2) % 3, p.normalAxis};
  const std::array<std::int32_t, 3> scales = scalesOf(p, axes);
  std::array<std::int64_t, 2> residuals{};
  glm::ivec3 result(0);
  for (int i = 0; i < 3; ++i) {
    const int axis = axes[i];
    std::int64_t expected = n.parent[axis] + offset[axis];
    if (i == 2 && p.normal[axis] != 0) {
      const std::int64_t sign = p.normal[axis] > 0 ? 1 : -1;
      // Residuals are clamped so that damaged bytes cannot overflow the products.
      constexpr std::int64_t kFar = 1 << 22;
      const std::int64_t drift = p.normal[axes[0]] * std::clamp(residuals[0], -kFar, kFar) +
                                 p.normal[axes[1]] * std::clamp(residuals[1], -kFar, kFar);
      expected -= roundedQuotient(sign * drift, sign * p.normal[axis]);
    }
    const std::int32_t residual = codeSigned(
        bins,
        residualContext(scales[i], i == 2),
        static_cast<std::int32_t>(position[axis] - expected));
    if (i < 2) residuals[static_cast<std::size_t>(i)] = residual;
    result[axis] = static_cast<std::int32_t>(expected + residual);
  }
  position = result;
}

/// Moves follow from the volume but for what rounding leaves, so that their residuals are of fixed
/// scales: of the first two axes, and of the last.
inline constexpr std::int32_t kMoveScale = 6;
inline constexpr std::int32_t kVolumeScale = 9;

/// Whether a split moves its parent, and where: its displacement, in and out, zero if not. The axis
/// along which the plane of equal volume is fixed best comes last. n, p: what the new vertex's
/// `position` was coded with.
template <class Bins>
void codeMove(
    Bins& bins,
    const Neighbourhood& n,
    const Fan& fan,
    const Prediction& p,
    const MoveWeights& weights,
    const glm::ivec3& position,
    glm::ivec3& displacement) {
  const MovePrediction move = predictMove(n, fan, p, position);
  const bool moves = bins.code(
      kMoved + std::min(move.distanceClass, kMovedClasses - 1),
      displacement != glm::ivec3(0));
  if (!moves) {
    displacement = glm::ivec3(0);
    return;
  }
  const Wide expected = weighed(Wide(0), move.terms, weights[p.weightClass]);
  int last = p.normalAxis;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(move.area[axis]) > std::abs(move.area[last])) last = axis;
  }
  const int axes[3] = {(last + 1) % 3, (last + 2) % 3, last};
  const bool hasPlane = move.area[last] != 0;
  const auto near = [](std::int64_t a) {
    constexpr std::int64_t kFar = 1 << 22;  // damaged bytes must not overflow the products
    return std::clamp(a, -kFar, kFar);
  };
  glm::ivec3 result(0);
  std::int64_t before = 0;  // what the first axes have of area · x
  for (int i = 0; i < 3; ++i) {
    const int axis = axes[i];
    std::int64_t center = near(expected[axis]);
    std::int32_t scale = kMoveScale;
    if (i == 2 && hasPlane) {
      const std::int64_t sign = move.area[axis] > 0 ? 1 : -1;
      center = near(roundedQuotient(sign * (-move.swept - before), sign * move.area[axis]));
      scale = kVolumeScale;
    }
    const std::int32_t residual = codeSigned(
        bins,
        residualContext(scale, i == 2),
        static_cast<std::int32_t>(displacement[axis] - center));
    result[axis] = static_cast<std::int32_t>(center + residual);
    before += move.area[axis] * near(result[axis]);
  }
  displacement = result;
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
