// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/client/render/line_flaws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace limn::flaws {
namespace {

using Line = std::vector<glm::dvec2>;

constexpr int kSize = 128;
constexpr double kWidthPx = 2.6;

double distanceTo(const Line& line, glm::dvec2 p) {
  double nearest = kSize;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const glm::dvec2 d = line[i + 1] - line[i];
    const double t = std::clamp(glm::dot(p - line[i], d) / glm::dot(d, d), 0.0, 1.0);
    nearest = std::min(nearest, glm::distance(p, line[i] + t * d));
  }
  return nearest;
}

/// Black lines with soft edges and round ends on white.
Image drawn(const std::vector<Line>& lines) {
  Image picture{kSize, kSize, {}};
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      double ink = 0.0;
      for (const Line& line : lines) {
        const double inside = kWidthPx / 2 - distanceTo(line, {x + 0.5, y + 0.5});
        ink = std::max(ink, std::clamp(inside + 0.5, 0.0, 1.0));
      }
      const auto grey = static_cast<std::uint8_t>(255 - std::lround(255 * ink));
      picture.rgba.insert(picture.rgba.end(), {grey, grey, grey, 255});
    }
  }
  return picture;
}

Line circle(glm::dvec2 middle, double radius) {
  Line line;
  for (int k = 0; k <= 90; ++k) {
    const double angle = 2 * std::numbers::pi * k / 90;
    line.push_back(middle + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return line;
}

/// Turned about the picture's middle, so that nothing depends on the rows of pixels.
Line turned(const Line& line, double degrees) {
  const double c = std::cos(glm::radians(degrees));
  const double s = std::sin(glm::radians(degrees));
  const glm::dvec2 middle(kSize / 2.0);
  Line result;
  for (const glm::dvec2& p : line) {
    const glm::dvec2 d = p - middle;
    result.push_back(middle + glm::dvec2(c * d.x - s * d.y, s * d.x + c * d.y));
  }
  return result;
}

Flaws flawsOf(const std::vector<Line>& lines, double degrees) {
  std::vector<Line> all;
  for (const Line& line : lines)
    all.push_back(turned(line, degrees));
  return find(drawn(all));
}

constexpr std::array<double, 6> kTurns = {0.0, 17.0, 45.0, 71.0, 90.0, 133.0};

TEST(LineFlaws, ABreakIsFoundOnceWithItsLength) {
  for (const double turn : kTurns) {
    // Round ends reach half a width into the break.
    const Flaws found =
        flawsOf({{{20, 64}, {60 - kWidthPx / 2, 64}}, {{66 + kWidthPx / 2, 64}, {108, 64}}}, turn);
    ASSERT_EQ(found.breaks.size(), 1U) << turn;
    EXPECT_NEAR(found.breaks[0].px, 6.0, 1.5) << turn;
    EXPECT_TRUE(found.doubles.empty()) << turn;
  }
}

TEST(LineFlaws, AnEndThatLooksAwayFromTheOtherIsNoBreak) {
  for (const double turn : kTurns) {
    const Flaws found = flawsOf({{{20, 64}, {60, 64}}, {{66, 66}, {66, 108}}}, turn);
    EXPECT_TRUE(found.breaks.empty()) << turn;
  }
}

TEST(LineFlaws, AWideOpeningIsNoBreak) {
  for (const double turn : kTurns)
    EXPECT_TRUE(flawsOf({{{20, 64}, {50, 64}}, {{70, 64}, {108, 64}}}, turn).breaks.empty());
}

TEST(LineFlaws, ADotInABreakIsNoLine) {
  for (const double turn : kTurns) {
    const std::vector<Line> dotted = {
        {{20, 64}, {58, 64}},
        {{64, 64}, {64.2, 64}},
        {{70, 64}, {108, 64}}};
    const Flaws found = flawsOf(dotted, turn);
    ASSERT_EQ(found.breaks.size(), 1U) << turn;
    EXPECT_NEAR(found.breaks[0].px, 9.4, 1.5) << turn;
  }
}

TEST(LineFlaws, LinesSideBySideAreDoubledAsFarAsTheyAreNear) {
  for (const double turn : kTurns) {
    for (const double apart : {2.4, 3.2, 4.0, 4.8}) {
      const Flaws found = flawsOf(
          {{{20, 64}, {108, 64}}, {{40, 90}, {49, 64 + apart}, {79, 64 + apart}, {88, 90}}},
          turn);
      ASSERT_EQ(found.doubles.size(), 1U) << turn << ", " << apart;
      EXPECT_NEAR(found.doubles[0].px, 30.0, 6.0) << turn << ", " << apart;
    }
    const Flaws wide = flawsOf({{{20, 64}, {108, 64}}, {{20, 74}, {108, 74}}}, turn);
    EXPECT_TRUE(wide.doubles.empty()) << turn;
    EXPECT_TRUE(wide.breaks.empty()) << turn;
  }
}

TEST(LineFlaws, AStubAlongALineIsDoubledAndSoIsABlob) {
  const Line line = {{20, 64}, {108, 64}};
  const Line stub = {{56, 64}, {76, 67}};
  Line blob;
  for (int k = 0; k <= 8; ++k)
    blob.emplace_back(60 + k, k % 2 == 0 ? 85 : 93);
  for (const double turn : kTurns) {
    EXPECT_EQ(flawsOf({line, stub}, turn).doubles.size(), 1U) << turn;
    EXPECT_EQ(flawsOf({line, blob}, turn).doubles.size(), 1U) << turn;
  }
}

TEST(LineFlaws, JunctionsCrossingsCornersAndCirclesAreNone) {
  const std::vector<std::vector<Line>> clean = {
      {{{20, 64}, {108, 64}}, {{64, 64}, {64, 108}}},            // T
      {{{20, 64}, {108, 64}}, {{64, 64}, {104, 84}}},            // T, slanted
      {{{20, 64}, {108, 64}}, {{64, 20}, {64, 108}}},            // X
      {{{20, 54}, {108, 74}}, {{20, 74}, {108, 54}}},            // X, slanted
      {{{20, 64}, {64, 64}, {104, 40}}, {{64, 64}, {104, 88}}},  // Y
      {{{20, 50}, {100, 64}, {20, 78}}},                         // a sharp corner
      {circle({64, 64}, 40)},
      {circle({64, 64}, 8)}};
  for (std::size_t i = 0; i < clean.size(); ++i) {
    for (const double turn : kTurns) {
      const Flaws found = flawsOf(clean[i], turn);
      EXPECT_TRUE(found.breaks.empty()) << i << ", " << turn;
      EXPECT_TRUE(found.doubles.empty()) << i << ", " << turn;
    }
  }
}

}  // namespace
}  // namespace limn::flaws
