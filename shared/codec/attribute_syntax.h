// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/neighbourhood.h"
#include "shared/mesh/vertex_attributes.h"
#include "shared/progressive/vertex_split.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

/// What a split brings besides its shape: colour, normal and seams, written once for both ends of
/// the coder. protocol/SPEC.md, "Attributes", is the specification. Like the position's, every
/// prediction looks at the prerequisites only, and is made of integers.
namespace limn::attribute_syntax {

using split_syntax::Fan;
using split_syntax::Neighbourhood;
using split_syntax::Wide;

// ---- Contexts (context 0 is an even bit) --------------------------------------------------------

inline constexpr std::uint32_t kMagnitudeBins = 12;
/// A number takes so many: its bit length in unary, then the bit below the top.
inline constexpr std::uint32_t kNumberContexts = 2 * kMagnitudeBins;
inline constexpr std::uint32_t kBefore = 4;  // classes of the residual before this one
inline constexpr std::uint32_t kColorSpreads = 16;
inline constexpr std::uint32_t kNormalSpreads = 20;

inline constexpr std::uint32_t kFirstChannel = 1;  // green, by spread
inline constexpr std::uint32_t kOtherChannels =
    kFirstChannel + kColorSpreads * kNumberContexts;  // by spread and the residual before
inline constexpr std::uint32_t kFirstNormal =
    kOtherChannels + kColorSpreads * kBefore * kNumberContexts;  // by spread
inline constexpr std::uint32_t kSecondNormal =
    kFirstNormal + kNormalSpreads * kNumberContexts;  // by spread and the residual before
inline constexpr std::uint32_t kAnySeam =
    kSecondNormal + kNormalSpreads * kBefore * kNumberContexts;  // by: any crease, any contrast
inline constexpr std::uint32_t kSeamEdge = kAnySeam + 4;  // by edge and whether it is a crease
inline constexpr std::uint32_t kContexts = kSeamEdge + 10;

// ---- Numbers -----------------------------------------------------------------------------------

/// A number from 0 to 2046: see split_syntax::codeNumber, with fewer contexts.
template <class Bins>
std::uint32_t codeNumber(Bins& bins, std::uint32_t context, std::uint32_t value) {
  const auto bits = static_cast<std::uint32_t>(std::bit_width(value + 1)) - 1;
  std::uint32_t length = 0;
  while (length < kMagnitudeBins - 1 && bins.code(context + length, length < bits))
    ++length;
  std::uint32_t result = 1;
  for (std::uint32_t i = length; i-- > 0;) {
    const std::uint32_t at = i + 1 == length ? context + kMagnitudeBins + length : 0;
    result = result << 1 | (bins.code(at, ((value + 1) >> i & 1) != 0) ? 1U : 0U);
  }
  return result - 1;
}

template <class Bins>
std::int32_t codeSigned(Bins& bins, std::uint32_t context, std::int32_t value) {
  const auto magnitude = static_cast<std::int32_t>(
      codeNumber(bins, context, static_cast<std::uint32_t>(std::abs(value))));
  if (magnitude == 0) return 0;
  return bins.code(0, value < 0) ? -magnitude : magnitude;
}

/// Half steps of the binary logarithm, from 0 for 0.
inline std::uint32_t spreadClass(std::int64_t spread, std::uint32_t classes) {
  const std::int32_t log = split_syntax::log8(static_cast<std::uint64_t>(spread));
  return static_cast<std::uint32_t>(
      std::clamp(log / 4 + 1, 0, static_cast<std::int32_t>(classes) - 1));
}

inline std::uint32_t beforeClass(std::int32_t residual) {
  return std::min(
      static_cast<std::uint32_t>(std::bit_width(static_cast<std::uint32_t>(std::abs(residual)))),
      kBefore - 1);
}

// ---- What is predicted from --------------------------------------------------------------------

/// The new vertex's neighbours: its parent, then the fan, counter-clockwise.
struct Neighbours {
  std::uint32_t count = 0;
  bool isCycle = false;  // the vertex is not on a border: its parent closes the fan
  std::array<VertexAttributes, split_syntax::kMaxRing + 1> attributes;
  std::array<Wide, split_syntax::kMaxRing + 1> offsets;  // from the new vertex
};

/// ringAttributes(i): of ring vertex i.
template <class RingAttributes>
Neighbours neighboursOf(
    const Neighbourhood& n,
    const RingCut& cut,
    const glm::ivec3& position,
    const VertexAttributes& parent,
    RingAttributes ringAttributes) {
  const Fan fan = split_syntax::fanOf(n, cut);
  Neighbours result;
  result.count = fan.count + 1;
  result.isCycle = cut.left != RingCut::kNoCut && cut.right != RingCut::kNoCut;
  const Wide toParent(n.parent - position);
  result.attributes[0] = parent;
  result.offsets[0] = toParent;
  for (std::uint32_t k = 0; k < fan.count; ++k) {
    const std::uint32_t i = n.wrap(fan.first + k);
    result.attributes[k + 1] = ringAttributes(i);
    result.offsets[k + 1] = Wide(n.ring[i]) + toParent;
  }
  return result;
}

/// Nearer neighbours count for more.
inline std::int64_t weightOf(const Wide& offset) {
  return (std::int64_t{1} << 24) / (1 + split_syntax::sumNorm(offset));
}

// ---- Colour ------------------------------------------------------------------------------------

template <class Bins>
SrgbColor codeColor(Bins& bins, const Neighbours& n, const SrgbColor& color) {
  Wide sum(0);
  std::int64_t weights = 0;
  glm::ivec3 low(255);
  glm::ivec3 high(0);
  for (std::uint32_t i = 0; i < n.count; ++i) {
    const glm::ivec3 c(n.attributes[i].color);
    const std::int64_t weight = weightOf(n.offsets[i]) + 1;
    sum += weight * Wide(c);
    weights += weight;
    low = glm::min(low, c);
    high = glm::max(high, c);
  }
  const glm::ivec3 range = high - low;
  const std::uint32_t spread = spreadClass(range.x + range.y + range.z, kColorSpreads);
  glm::ivec3 result(0);
  std::int32_t before = 0;
  constexpr int kOrder[] = {1, 0, 2};
  for (const int channel : kOrder) {
    const auto mean = static_cast<std::int32_t>((sum[channel] + weights / 2) / weights);
    // Channels go up and down together.
    const std::int32_t expected = std::clamp(mean + before, 0, 255);
    const std::uint32_t context =
        channel == 1 ? kFirstChannel + spread * kNumberContexts
                     : kOtherChannels + (spread * kBefore + beforeClass(before)) * kNumberContexts;
    const std::int32_t residual = codeSigned(bins, context, color[channel] - expected);
    result[channel] = std::clamp(expected + residual, 0, 255);
    before = result[channel] - mean;
  }
  return SrgbColor(result);
}

// ---- Normal ------------------------------------------------------------------------------------

/// `v` with a sum norm of about 2^12; zero stays zero.
inline Wide levelled(const Wide& v) {
  const std::int64_t length = split_syntax::sumNorm(v);
  if (length == 0) return v;
  return {v.x * 4096 / length, v.y * 4096 / length, v.z * 4096 / length};
}

/// Axes and signs that put the largest coordinate of a vector up; its own inverse but for the order
/// of the axes.
struct Upright {
  int up = 2;
  bool isDown = false;

  explicit Upright(const Wide& v) {
    for (int axis = 1; axis >= 0; --axis) {
      if (std::abs(v[axis]) > std::abs(v[up])) up = axis;
    }
    isDown = v[up] < 0;
  }

  template <class Vector>
  [[nodiscard]] Vector turn(const Vector& v) const {
    const Vector turned(v[(up + 1) % 3], v[(up + 2) % 3], v[up]);
    return isDown ? -turned : turned;
  }

  template <class Vector>
  [[nodiscard]] Vector turnBack(const Vector& v) const {
    Vector result(0);
    for (int k = 0; k < 3; ++k)
      result[(up + 1 + k) % 3] = isDown ? -v[k] : v[k];
    return result;
  }
};

template <class Bins>
OctNormal codeNormal(Bins& bins, const Neighbours& n, const OctNormal& normal) {
  Wide mean(0);
  for (std::uint32_t i = 0; i < n.count; ++i)
    mean += (weightOf(n.offsets[i]) + 1) * Wide(octPoint(n.attributes[i].normal));
  mean = levelled(mean);
  Wide surface(0);
  for (std::uint32_t i = n.isCycle ? 0 : 1; i < n.count; ++i) {
    if (i + 1 < n.count || n.isCycle)
      surface += split_syntax::cross(n.offsets[i], n.offsets[i + 1 < n.count ? i + 1 : 0]);
  }
  surface = levelled(surface);
  if (split_syntax::dot(mean, surface) <= 0) surface = Wide(0);
  std::int64_t spread = 0;
  for (std::uint32_t i = 0; i < n.count; ++i) {
    const Wide difference = Wide(8 * octPoint(n.attributes[i].normal)) - mean;
    spread += split_syntax::sumNorm(difference);
  }
  spread = (spread / n.count + split_syntax::sumNorm(surface - mean)) / 8;

  const Wide expected = mean + surface;
  const Upright upright(expected);
  // Rounded to a point of the octahedron: the third coordinate takes up what is left.
  const Wide turned = upright.turn(expected);
  const std::int64_t length = std::max<std::int64_t>(split_syntax::sumNorm(turned), 1);
  const glm::ivec2 centre(
      split_syntax::roundedQuotient(turned.x * kOctRadius, length),
      split_syntax::roundedQuotient(turned.y * kOctRadius, length));
  const glm::ivec2 wanted = octUnfold(upright.turn(octPoint(normal)));
  const std::uint32_t scale = spreadClass(spread, kNormalSpreads);
  const std::int32_t first =
      codeSigned(bins, kFirstNormal + scale * kNumberContexts, wanted.x - centre.x);
  const std::int32_t second = codeSigned(
      bins,
      kSecondNormal + (scale * kBefore + beforeClass(first)) * kNumberContexts,
      wanted.y - centre.y);
  const glm::ivec2 coded = glm::clamp(centre + glm::ivec2(first, second), -kOctRadius, kOctRadius);
  return octNormal(upright.turnBack(octPoint(coded)));
}

// ---- Seams -------------------------------------------------------------------------------------

/// creases: the split's features, which the receiver has.
template <class Bins>
std::uint8_t codeSeams(Bins& bins, const Neighbours& n, std::uint8_t creases, std::uint8_t seams) {
  constexpr std::uint8_t kEdges = 31;
  const bool contrast = !std::all_of(
      n.attributes.begin(),
      n.attributes.begin() + n.count,
      [&](const VertexAttributes& a) { return a.color == n.attributes[0].color; });
  const std::uint32_t any = ((creases & kEdges) != 0 ? 1U : 0U) + (contrast ? 2U : 0U);
  if (!bins.code(kAnySeam + any, (seams & kEdges) != 0)) return 0;
  std::uint8_t result = 0;
  for (std::uint32_t i = 0; i < 5; ++i) {
    if (bins.code(kSeamEdge + 2 * i + (creases >> i & 1), (seams >> i & 1) != 0))
      result |= static_cast<std::uint8_t>(1U << i);
  }
  return result;
}

/// A split's attributes and seams, of the kinds that the model has. split: in and out; its shape is
/// known.
template <class Bins>
void codeAttributes(Bins& bins, const Neighbours& n, std::uint8_t kinds, VertexSplit& split) {
  if ((kinds & kAttributeColors) != 0)
    split.attributes.color = codeColor(bins, n, split.attributes.color);
  if ((kinds & kAttributeNormals) != 0)
    split.attributes.normal = codeNormal(bins, n, split.attributes.normal);
  if ((kinds & kAttributeSeams) != 0) split.seams = codeSeams(bins, n, split.features, split.seams);
}

}  // namespace limn::attribute_syntax
