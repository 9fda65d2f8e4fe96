// SPDX-License-Identifier: Apache-2.0
#include "server/session/window.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(Window, ClosesWhenFullAndOpensWithAcknowledgements) {
  Window window(100);
  EXPECT_TRUE(window.allows(100));
  window.sent(60);
  EXPECT_TRUE(window.allows(40));
  EXPECT_FALSE(window.allows(41));
  ASSERT_TRUE(window.acknowledge(30));
  EXPECT_EQ(window.inFlightBytes(), 30U);
  EXPECT_TRUE(window.allows(70));
  ASSERT_TRUE(window.acknowledge(10)) << "a late report changes nothing";
  EXPECT_EQ(window.inFlightBytes(), 30U);
}

TEST(Window, LetsAMessageLargerThanItselfThroughAlone) {
  Window window(100);
  EXPECT_TRUE(window.allows(1000));
  window.sent(1000);
  EXPECT_FALSE(window.allows(1));
}

TEST(Window, RefusesToHearOfMoreThanWasSent) {
  Window window(100);
  window.sent(50);
  EXPECT_FALSE(window.acknowledge(51));
  EXPECT_EQ(window.inFlightBytes(), 50U);
}

}  // namespace
}  // namespace limn
