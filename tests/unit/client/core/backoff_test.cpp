// SPDX-License-Identifier: Apache-2.0
#include "client/core/backoff.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

constexpr std::uint64_t kHourMs = 3'600'000;

TEST(Backoff, DoublesUpToFiveSecondsWithUpToHalfOfItAsJitter) {
  Backoff backoff(kHourMs, 1);
  std::uint64_t now = 1000;
  for (const std::uint64_t least : {100U, 200U, 400U, 800U, 1600U, 3200U, 5000U, 5000U}) {
    const auto at = backoff.next(now, 0);
    ASSERT_TRUE(at);
    EXPECT_GE(*at, now + least);
    EXPECT_LE(*at, now + least + least / 2);
    now = *at;
  }
}

TEST(Backoff, NeverTriesBeforeTheServerAskedForIt) {
  Backoff backoff(kHourMs, 1);
  EXPECT_GE(*backoff.next(0, 7000), 7000U);
}

TEST(Backoff, GivesUpAfterLossesInARowAndBeginsAnewAfterProgress) {
  Backoff backoff(1000, 1);
  EXPECT_TRUE(backoff.next(0, 0));
  EXPECT_FALSE(backoff.next(900, 0));
  backoff.reset();
  const auto at = backoff.next(900, 0);
  ASSERT_TRUE(at);
  EXPECT_LE(*at, 900U + 150U);
}

TEST(Backoff, ClientsOfOtherSeedsSpreadOut) {
  Backoff one(kHourMs, 1);
  Backoff other(kHourMs, 2);
  bool differs = false;
  for (int i = 0; i < 8; ++i)
    differs = differs || one.next(0, 0) != other.next(0, 0);
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace limn
