// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/contour_codec.h"

#include "shared/codec/adaptive_bins.h"
#include "shared/codec/hull_syntax.h"
#include "shared/codec/varint.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <string>

namespace limn {
namespace {

using hull_syntax::codeNumber;
using hull_syntax::codeSigned;
using hull_syntax::kNumberContexts;

constexpr int kMaxCoordinate = 1 << 23;
/// How much of the last difference the next one is expected to be, in quarters.
constexpr std::uint32_t kMaxWeight = 4;
constexpr std::uint32_t kSizes = 16;

constexpr std::uint32_t kClosed = 1;
constexpr std::uint32_t kLength = kClosed + 1;
constexpr std::uint32_t kJump = kLength + kNumberContexts;
constexpr std::uint32_t kStep = kJump + kNumberContexts;  // by size of the last difference
constexpr std::uint32_t kContexts = kStep + kSizes * kNumberContexts;

std::uint32_t sizeOf(const glm::ivec3& difference) {
  const auto sum = static_cast<std::uint32_t>(
      std::abs(difference.x) + std::abs(difference.y) + std::abs(difference.z));
  return std::min(static_cast<std::uint32_t>(std::bit_width(sum)), kSizes - 1);
}

/// Rounded towards zero, as integers divide.
glm::ivec3 expected(const glm::ivec3& last, std::uint32_t weight) {
  return last * static_cast<int>(weight) / 4;
}

/// The weight that leaves least to code.
std::uint32_t bestWeight(const ContourLines& lines) {
  std::array<std::uint64_t, kMaxWeight + 1> bits{};
  for (const ContourLines::Line& line : lines.lines) {
    glm::ivec3 last{0};
    for (std::uint32_t i = line.begin + 1; i < line.end; ++i) {
      const glm::ivec3 difference = lines.points[i] - lines.points[i - 1];
      for (std::uint32_t w = 0; w <= kMaxWeight; ++w) {
        const glm::ivec3 rest = difference - expected(last, w);
        for (int axis = 0; axis < 3; ++axis)
          bits[w] += static_cast<std::uint64_t>(
              std::bit_width(static_cast<std::uint32_t>(std::abs(rest[axis]))));
      }
      last = difference;
    }
  }
  return static_cast<std::uint32_t>(std::min_element(bits.begin(), bits.end()) - bits.begin());
}

template <class Bins>
glm::ivec3 codeVector(Bins& bins, std::uint32_t context, const glm::ivec3& value) {
  glm::ivec3 result{0};
  for (int axis = 0; axis < 3; ++axis)
    result[axis] = codeSigned(bins, context, value[axis]);
  return result;
}

tl::unexpected<Error> damaged(const char* what) {
  return fail(ErrorCode::kCorrupt, std::string("a contour is damaged: ") + what);
}

/// origin + difference, if it lies in range; differences come from anybody.
bool moveBy(const glm::ivec3& difference, glm::ivec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t sum = std::int64_t{point[axis]} + difference[axis];
    if (std::abs(sum) > kMaxCoordinate) return false;
    point[axis] = static_cast<int>(sum);
  }
  return true;
}

}  // namespace

std::vector<std::uint8_t> encodeContour(const ContourLines& lines) {
  std::vector<std::uint8_t> bytes;
  const std::uint32_t weight = bestWeight(lines);
  appendVarint(static_cast<std::uint64_t>(lines.extraBits), bytes);
  appendVarint(lines.points.size(), bytes);
  if (lines.points.empty()) return bytes;
  appendVarint(lines.lines.size(), bytes);
  appendVarint(weight, bytes);
  AdaptiveContexts contexts(kContexts);
  AdaptiveBinWriter bins(contexts);
  glm::ivec3 start{0};
  for (const ContourLines::Line& line : lines.lines) {
    bins.code(kClosed, line.closed);
    codeNumber(bins, kLength, line.end - line.begin - 1);
    codeVector(bins, kJump, lines.points[line.begin] - start);
    start = lines.points[line.begin];
    glm::ivec3 last{0};
    for (std::uint32_t i = line.begin + 1; i < line.end; ++i) {
      const glm::ivec3 difference = lines.points[i] - lines.points[i - 1];
      codeVector(bins, kStep + sizeOf(last) * kNumberContexts, difference - expected(last, weight));
      last = difference;
    }
  }
  const std::vector<std::uint8_t> stream = bins.finish();
  bytes.insert(bytes.end(), stream.begin(), stream.end());
  return bytes;
}

Result<ContourLines> decodeContour(std::span<const std::uint8_t> bytes, std::uint32_t maxPoints) {
  VarintReader header(bytes);
  const auto extraBits = header.read();
  const auto points = header.read();
  if (!extraBits || *extraBits > kMaxContourExtraBits || !points) return damaged("its header");
  if (*points > maxPoints) {
    return fail(ErrorCode::kLimitExceeded, "a contour has more points than is allowed");
  }
  ContourLines result;
  result.extraBits = static_cast<int>(*extraBits);
  if (*points == 0) {
    if (!header.atEnd()) return damaged("bytes left over");
    return result;
  }
  const auto lines = header.read();
  const auto weight = header.read();
  if (!lines || *lines == 0 || *lines > *points || !weight || *weight > kMaxWeight) {
    return damaged("its header");
  }
  AdaptiveContexts contexts(kContexts);
  AdaptiveBinReader bins(contexts, header.rest());
  if (!bins.isValid()) return damaged("no coded bits");
  glm::ivec3 start{0};
  for (std::uint32_t n = 0; n < *lines; ++n) {
    ContourLines::Line line;
    line.closed = bins.code(kClosed);
    line.begin = static_cast<std::uint32_t>(result.points.size());
    const std::uint32_t length = codeNumber(bins, kLength, 0) + 1;
    if (length > *points - line.begin) return damaged("more points than it says");
    line.end = line.begin + length;
    if (!moveBy(codeVector(bins, kJump, glm::ivec3(0)), start)) return damaged("a far point");
    result.points.push_back(start);
    glm::ivec3 point = start;
    glm::ivec3 last{0};
    for (std::uint32_t i = 1; i < length; ++i) {
      const glm::ivec3 rest =
          codeVector(bins, kStep + sizeOf(last) * kNumberContexts, glm::ivec3(0));
      const glm::ivec3 before = point;
      if (!moveBy(rest, point) || !moveBy(expected(last, *weight), point)) {
        return damaged("a far point");
      }
      last = point - before;
      result.points.push_back(point);
    }
    result.lines.push_back(line);
  }
  if (result.points.size() != *points) return damaged("fewer points than it says");
  if (!bins.isFinished()) return damaged("bytes left over or missing");
  return result;
}

}  // namespace limn
