// SPDX-License-Identifier: Apache-2.0
#include "server/transport/limits.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(ConnectionCounter, KeepsToBothLimits) {
  ConnectionCounter counter;
  const auto enters = [&](const char* address) {
    if (counter.full(address, 3, 2)) return false;
    counter.enter(address);
    return true;
  };
  EXPECT_TRUE(enters("a"));
  EXPECT_TRUE(enters("a"));
  EXPECT_EQ(counter.full("a", 3, 2), Refusal::kAddress);
  EXPECT_FALSE(counter.full("a", 3, 0)) << "no limit by address";
  EXPECT_TRUE(enters("b"));
  EXPECT_EQ(counter.full("c", 3, 2), Refusal::kTotal);
  counter.leave("a");
  EXPECT_TRUE(enters("c"));
  counter.leave("never");
  EXPECT_EQ(counter.total(), 3U);
}

TEST(AddressKey, CountsAnIpv6NetworkAsOne) {
  EXPECT_EQ(addressKey("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(addressKey("::ffff:192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(addressKey("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::/64");
  EXPECT_EQ(addressKey("2001:db8:1:2::9"), addressKey("2001:db8:1:2:3:4:5:6"));
  EXPECT_NE(addressKey("2001:db8:1:3::9"), addressKey("2001:db8:1:2::9"));
  EXPECT_EQ(addressKey("unknown"), "unknown");
}

}  // namespace
}  // namespace limn
