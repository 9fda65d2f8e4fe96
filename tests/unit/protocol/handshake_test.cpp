// SPDX-License-Identifier: Apache-2.0
#include "protocol/handshake.h"

#include <gtest/gtest.h>

namespace limn::protocol {
namespace {

TEST(Handshake, FindsTheSubprotocolAmongOthers) {
  EXPECT_TRUE(offersSubprotocol("limn.1"));
  EXPECT_TRUE(offersSubprotocol("chat, limn.1"));
  EXPECT_TRUE(offersSubprotocol(" \tlimn.1 ,x"));
  EXPECT_FALSE(offersSubprotocol(""));
  EXPECT_FALSE(offersSubprotocol(",, ,"));
  EXPECT_FALSE(offersSubprotocol("limn.10"));
  EXPECT_FALSE(offersSubprotocol("xlimn.1"));
  EXPECT_FALSE(offersSubprotocol("LIMN.1"));
}

TEST(Handshake, AgreesOnTheLowerVersion) {
  EXPECT_EQ(negotiateVersion(1).value(), 1);
  EXPECT_EQ(negotiateVersion(65535).value(), 1);
  EXPECT_FALSE(negotiateVersion(0));
}

TEST(Handshake, RefusesAVersionThatWasNotOffered) {
  EXPECT_TRUE(checkWelcome(1));
  EXPECT_FALSE(checkWelcome(0));
  EXPECT_FALSE(checkWelcome(2));
}

}  // namespace
}  // namespace limn::protocol
