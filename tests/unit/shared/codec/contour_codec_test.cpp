// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/contour_codec.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

constexpr std::uint32_t kMost = 1U << 16;

/// Lines that wander about, closed and open, of 1 to about `length` points.
ContourLines wandering(std::uint64_t seed, std::uint32_t lines, std::uint32_t length, int step) {
  Rng rng(seed);
  ContourLines result;
  result.extraBits = static_cast<int>(seed % 5);
  const auto offset = [&] {
    const auto any = [&] {
      return static_cast<int>(rng.below(static_cast<std::uint32_t>(2 * step + 1))) - step;
    };
    return glm::ivec3(any(), any(), any());
  };
  for (std::uint32_t n = 0; n < lines; ++n) {
    ContourLines::Line line;
    line.begin = static_cast<std::uint32_t>(result.points.size());
    glm::ivec3 point(static_cast<int>(rng.below(16384)), 0, static_cast<int>(rng.below(16384)));
    const std::uint32_t count = 1 + rng.below(length);
    for (std::uint32_t i = 0; i < count; ++i) {
      result.points.push_back(point);
      point += offset();
    }
    line.end = static_cast<std::uint32_t>(result.points.size());
    line.closed = rng.below(2) == 0;
    result.lines.push_back(line);
  }
  return result;
}

TEST(ContourCodec, DecodesToWhatWasEncoded) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const ContourLines lines = wandering(seed, 20, 60, 1 << seed);
    const auto decoded = decodeContour(encodeContour(lines), kMost);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(*decoded, lines);
  }
}

TEST(ContourCodec, NothingTakesTwoBytes) {
  const auto bytes = encodeContour({});
  EXPECT_EQ(bytes.size(), 2U);
  const auto decoded = decodeContour(bytes, kMost);
  ASSERT_TRUE(decoded);
  EXPECT_TRUE(decoded->points.empty());
}

TEST(ContourCodec, FarPointsSurvive) {
  ContourLines lines;
  lines.points = {{1 << 22, -(1 << 22), 0}, {-(1 << 22), 1 << 22, 1 << 22}};
  lines.lines = {{0, 2, false}};
  const auto decoded = decodeContour(encodeContour(lines), kMost);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(*decoded, lines);
}

TEST(ContourCodec, RefusesMorePointsThanAllowed) {
  const ContourLines lines = wandering(1, 10, 50, 3);
  const auto decoded =
      decodeContour(encodeContour(lines), static_cast<std::uint32_t>(lines.points.size()) - 1);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::kLimitExceeded);
}

TEST(ContourCodec, NeverTakesAPartForTheWhole) {
  const ContourLines lines = wandering(2, 6, 30, 5);
  const auto bytes = encodeContour(lines);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const auto decoded = decodeContour(std::span(bytes).first(length), kMost);
    // A cut rANS stream may by chance be one of other lines; never of these.
    EXPECT_FALSE(decoded && *decoded == lines) << length;
  }
  auto longer = bytes;
  longer.push_back(0);
  const auto decoded = decodeContour(longer, kMost);
  EXPECT_FALSE(decoded && *decoded == lines);
}

TEST(ContourCodec, AnyBytesGiveAnErrorOrLinesInRange) {
  Rng rng(7);
  const auto good = encodeContour(wandering(3, 6, 30, 5));
  for (int round = 0; round < 20'000; ++round) {
    auto bytes = good;
    for (std::uint32_t i = 0; i <= rng.below(4); ++i)
      bytes[rng.below(static_cast<std::uint32_t>(bytes.size()))] =
          static_cast<std::uint8_t>(rng.below(256));
    const auto decoded = decodeContour(bytes, 1000);
    if (!decoded) continue;
    std::uint32_t at = 0;
    for (const ContourLines::Line& line : decoded->lines) {
      ASSERT_EQ(line.begin, at);
      ASSERT_GT(line.end, line.begin);
      at = line.end;
    }
    ASSERT_EQ(at, decoded->points.size());
    for (const glm::ivec3& p : decoded->points)
      ASSERT_LE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1 << 23);
  }
}

}  // namespace
}  // namespace limn
