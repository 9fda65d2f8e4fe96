// SPDX-License-Identifier: Apache-2.0
#include "client/apps/frame_path.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(FramePath, GetsItsNumber) {
  EXPECT_EQ(framePath("f%04d.png", 7), "f0007.png");
  EXPECT_EQ(framePath("f%d.png", 12), "f12.png");
  EXPECT_EQ(framePath("%02d/%02d.png", 123), "123/%02d.png");
  EXPECT_EQ(framePath("plain.png", 3), "plain.png");
  for (const char* hostile : {"%n", "%s%s", "%04x", "%", "100%", "%0d"}) {
    EXPECT_FALSE(hasFrameNumber(hostile)) << hostile;
    EXPECT_EQ(framePath(hostile, 1), hostile);
  }
}

}  // namespace
}  // namespace limn
