// SPDX-License-Identifier: Apache-2.0
#include "client/view/detail.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

constexpr Detail kBest;

double pixels(const Detail& detail) {
  return detail.scale * detail.scale * detail.supersample * detail.supersample;
}

TEST(DetailGovernor, DrawsAtItsBestUntilItKnowsBetter) {
  EXPECT_EQ(DetailGovernor(50.0).choose(true), kBest);
}

TEST(DetailGovernor, ComesDownToWhatTheBudgetAllowsAndStaysThere) {
  DetailGovernor governor(50.0);
  // A machine that takes 200 ms for the best picture, in proportion to the pixels.
  const auto cost = [](const Detail& detail) { return 200.0 * pixels(detail) / pixels(kBest); };
  for (int i = 0; i < 20; ++i) {
    const Detail detail = governor.choose(true);
    governor.learn(detail, cost(detail));
  }
  const Detail settled = governor.choose(true);
  EXPECT_LE(cost(settled), 50.0);
  governor.learn(settled, cost(settled));
  EXPECT_EQ(governor.choose(true), settled);
}

TEST(DetailGovernor, GoesUpAgainWhenThereIsRoomForIt) {
  DetailGovernor governor(50.0);
  for (int i = 0; i < 10; ++i)
    governor.learn(governor.choose(true), 400.0);
  EXPECT_LT(pixels(governor.choose(true)), pixels(kBest));
  for (int i = 0; i < 10; ++i)
    governor.learn(governor.choose(true), 1.0);
  EXPECT_EQ(governor.choose(true), kBest);
}

TEST(DetailGovernor, ARestingPictureIsAlwaysTheBest) {
  DetailGovernor governor(50.0);
  for (int i = 0; i < 10; ++i)
    governor.learn(governor.choose(true), 4000.0);
  EXPECT_EQ(governor.choose(false), kBest);
}

TEST(DetailGovernor, ASlowPictureAtRestDoesNotMakeMovingOnesCoarserThanTheyMustBe) {
  DetailGovernor governor(50.0);
  for (int i = 0; i < 10; ++i)
    governor.learn(kBest, 60.0);
  EXPECT_GE(pixels(governor.choose(true)), 1.0);
}

}  // namespace
}  // namespace limn
