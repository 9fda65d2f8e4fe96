// SPDX-License-Identifier: Apache-2.0
#include "server/session/rate_limit.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

int taken(RateLimit& limit, std::int64_t nowMs) {
  int count = 0;
  while (limit.take(nowMs))
    ++count;
  return count;
}

TEST(RateLimit, AllowsABurstThenTheRate) {
  RateLimit limit(10.0, 5.0);
  EXPECT_EQ(taken(limit, 1000), 5);
  EXPECT_EQ(taken(limit, 1000), 0);
  EXPECT_EQ(taken(limit, 1099), 0);
  EXPECT_EQ(taken(limit, 1300), 3);
  EXPECT_EQ(taken(limit, 900'000), 5) << "never more than the burst";
  EXPECT_EQ(taken(limit, 100), 0) << "a clock that goes back gives nothing";
}

TEST(RateLimit, MoreCanBeGiven) {
  RateLimit limit(1.0, 4.0);
  EXPECT_EQ(taken(limit, 0), 4);
  limit.give(2.5);
  EXPECT_EQ(taken(limit, 0), 2);
  limit.give(100.0);
  EXPECT_EQ(taken(limit, 0), 4);
}

}  // namespace
}  // namespace limn
