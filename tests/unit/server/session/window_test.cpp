// SPDX-License-Identifier: Apache-2.0
#include "server/session/window.h"

#include <gtest/gtest.h>

#include <deque>
#include <utility>

namespace limn {
namespace {

WindowOptions ofBytes(std::uint64_t bytes) {
  return {.mostBytes = bytes, .firstBytes = bytes, .leastBytes = bytes};
}

TEST(Window, ClosesWhenFullAndOpensWithAcknowledgements) {
  Window window(ofBytes(100));
  EXPECT_TRUE(window.allows(100));
  window.sent(60, 0);
  EXPECT_TRUE(window.allows(40));
  EXPECT_FALSE(window.allows(41));
  ASSERT_TRUE(window.acknowledge(30, 1));
  EXPECT_EQ(window.inFlightBytes(), 30U);
  EXPECT_TRUE(window.allows(70));
  ASSERT_TRUE(window.acknowledge(10, 2)) << "a late report changes nothing";
  EXPECT_EQ(window.inFlightBytes(), 30U);
}

TEST(Window, KnowsSinceWhenItWaits) {
  Window window(ofBytes(100));
  EXPECT_FALSE(window.waitingSinceMs());
  window.sent(10, 5);
  window.sent(10, 7);
  EXPECT_EQ(window.waitingSinceMs(), 5);
  ASSERT_TRUE(window.acknowledge(5, 9));
  EXPECT_EQ(window.waitingSinceMs(), 9);
  ASSERT_TRUE(window.acknowledge(5, 12));
  EXPECT_EQ(window.waitingSinceMs(), 9) << "the same again is no progress";
  ASSERT_TRUE(window.acknowledge(20, 13));
  EXPECT_FALSE(window.waitingSinceMs());
}

TEST(Window, LetsAMessageLargerThanItselfThroughAlone) {
  Window window(ofBytes(100));
  EXPECT_TRUE(window.allows(1000));
  window.sent(1000, 0);
  EXPECT_FALSE(window.allows(1));
}

TEST(Window, RefusesToHearOfMoreThanWasSent) {
  Window window(ofBytes(100));
  window.sent(50, 0);
  EXPECT_FALSE(window.acknowledge(51, 1));
  EXPECT_EQ(window.inFlightBytes(), 50U);
}

/// A link that carries so many bytes a millisecond and takes so long one way; the sender always has
/// 4 KiB more to send, until `untilMs`. Returns the longest that a message took in the second half.
std::int64_t
longestWay(Window& window, double bytesAMs, std::int64_t oneWayMs, std::int64_t untilMs) {
  std::deque<std::pair<std::int64_t, std::uint64_t>> acknowledgements;  // when, total
  double freeAtMs = 0.0;
  std::int64_t longest = 0;
  for (std::int64_t now = 0; now < untilMs; ++now) {
    while (!acknowledgements.empty() && acknowledgements.front().first <= now) {
      EXPECT_TRUE(window.acknowledge(acknowledgements.front().second, now));
      acknowledgements.pop_front();
    }
    while (window.allows(4096)) {
      window.sent(4096, now);
      freeAtMs = std::max(freeAtMs, static_cast<double>(now)) + 4096.0 / bytesAMs;
      const auto arrives = static_cast<std::int64_t>(freeAtMs) + oneWayMs;
      acknowledgements.emplace_back(arrives + oneWayMs, window.sentBytes());
      if (2 * now > untilMs) longest = std::max(longest, arrives - now);
    }
  }
  return longest;
}

TEST(Window, KeepsQueuesShortOnASlowLink) {
  Window window({});
  const std::int64_t longest = longestWay(window, 125.0, 20, 30'000);  // 1 Mbit/s
  EXPECT_LE(longest, 20 + 100 + 2 * 4096 / 125 + 50);
  // And the link is busy all the same.
  EXPECT_GT(static_cast<double>(window.sentBytes()), 0.9 * 125.0 * 30'000);
}

TEST(Window, OpensWideOnAFastLink) {
  Window window({});
  longestWay(window, 12'500.0, 25, 3'000);  // 100 Mbit/s
  EXPECT_EQ(window.limitBytes(), WindowOptions{}.mostBytes);
}

TEST(Window, FollowsALinkThatBecomesSlow) {
  Window window({});
  longestWay(window, 12'500.0, 5, 2'000);
  Window slowed = window;
  EXPECT_LE(longestWay(slowed, 60.0, 5, 30'000), 5 + 100 + 16 * 1024 / 60 + 50);
}

}  // namespace
}  // namespace limn
