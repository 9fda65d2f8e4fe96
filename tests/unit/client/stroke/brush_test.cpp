// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/brush.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr float kPeriod = 256.0F;

constexpr BrushKind kKinds[] = {
    BrushKind::kCharcoal,
    BrushKind::kLazy,
    BrushKind::kHand,
    BrushKind::kRough};

TEST(Brush, OffsetsReachTheAmplitudeButNotBeyond) {
  for (const BrushKind kind : kKinds) {
    const Brush brush = usualBrush(kind);
    float largest = 0.0F;
    for (float p = 0.0F; p < kPeriod; p += 0.25F) {
      const glm::vec2 offset = brushOffset(brush, p, kPeriod);
      largest = std::max({largest, std::abs(offset.x), std::abs(offset.y)});
    }
    EXPECT_LE(largest, 1.001F * brush.amplitudePx);
    EXPECT_GE(largest, 0.5F * brush.amplitudePx);
  }
}

TEST(Brush, EveryFunctionIsPeriodicSoThatLoopsClose) {
  for (const BrushKind kind : kKinds) {
    for (float wavelength : {3.0F, 41.0F, 500.0F}) {
      Brush brush = usualBrush(kind);
      brush.wavelengthPx = wavelength;
      for (float p = -20.0F; p < 600.0F; p += 7.3F) {
        const glm::vec2 a = brushOffset(brush, p, kPeriod);
        const glm::vec2 b = brushOffset(brush, p + kPeriod, kPeriod);
        EXPECT_NEAR(a.x, b.x, 0.01F);
        // A tooth of charcoal is steep.
        EXPECT_NEAR(a.y, b.y, kind == BrushKind::kCharcoal ? 0.1F : 0.01F);
      }
    }
  }
}

TEST(Brush, EachFunctionLeadsWhereThePaperSays) {
  float charcoalTurns = 0.0F;
  float lazyTurns = 0.0F;
  const auto turns = [](BrushKind kind) {
    const Brush brush = usualBrush(kind);
    int count = 0;
    for (float p = 0.5F; p < kPeriod; p += 0.25F) {
      const float before = brushOffset(brush, p - 0.25F, kPeriod).y;
      const float here = brushOffset(brush, p, kPeriod).y;
      const float after = brushOffset(brush, p + 0.25F, kPeriod).y;
      count += (here - before) * (after - here) < 0.0F ? 1 : 0;
    }
    return static_cast<float>(count);
  };
  charcoalTurns = turns(BrushKind::kCharcoal);
  lazyTurns = turns(BrushKind::kLazy);
  EXPECT_GT(charcoalTurns, 8.0F * lazyTurns);  // high frequency against low
  float handAlong = 0.0F;
  float handAcross = 0.0F;
  float roughAlong = 0.0F;
  for (float p = 0.0F; p < kPeriod; p += 0.5F) {
    const glm::vec2 hand = brushOffset(usualBrush(BrushKind::kHand), p, kPeriod);
    const glm::vec2 rough = brushOffset(usualBrush(BrushKind::kRough), p, kPeriod);
    handAlong = std::max(handAlong, std::abs(hand.x));
    handAcross = std::max(handAcross, std::abs(hand.y));
    roughAlong = std::max(roughAlong, std::abs(rough.x));
    EXPECT_EQ(rough.y, 0.0F);
    EXPECT_EQ(brushOffset(usualBrush(BrushKind::kLazy), p, kPeriod).x, 0.0F);
  }
  EXPECT_GT(handAlong, 0.0F);
  EXPECT_GT(handAcross, 0.0F);
  EXPECT_GT(roughAlong, 3.0F * handAlong);
}

TEST(Brush, SeedsDifferAndTheSameSeedAgrees) {
  Brush a = usualBrush(BrushKind::kHand);
  Brush b = a;
  EXPECT_EQ(brushOffset(a, 33.0F, kPeriod), brushOffset(b, 33.0F, kPeriod));
  b.seed = 2;
  EXPECT_NE(brushOffset(a, 33.0F, kPeriod), brushOffset(b, 33.0F, kPeriod));
}

TEST(Brush, NamesAreParsedAndOthersRefused) {
  EXPECT_EQ(parseBrushKind("lazy").value(), BrushKind::kLazy);
  EXPECT_EQ(parseBrushKind("none").value(), BrushKind::kPlain);
  const auto wrong = parseBrushKind("crayon");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("charcoal"), std::string::npos);
}

}  // namespace
}  // namespace limn
