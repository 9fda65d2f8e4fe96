// SPDX-License-Identifier: Apache-2.0
#include "shared/core/hmac.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

// RFC 4231, test cases 2 and 6.
TEST(Hmac, MatchesThePublishedVectors) {
  EXPECT_EQ(
      toHex(hmacSha256("Jefe", "what do ya want for nothing?")),
      "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
  EXPECT_EQ(
      toHex(hmacSha256(
          std::string(131, '\xAA'),
          "Test Using Larger Than Block-Size Key - Hash Key First")),
      "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
}

TEST(Hmac, SecretsAreTheSameOnlyWhole) {
  EXPECT_TRUE(sameSecret("", ""));
  EXPECT_TRUE(sameSecret("abc", "abc"));
  for (const char* other : {"", "ab", "abd", "abcd", "Abc"})
    EXPECT_FALSE(sameSecret(other, "abc")) << other;
  EXPECT_FALSE(sameSecret("a", ""));
}

}  // namespace
}  // namespace limn
