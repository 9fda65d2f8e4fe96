// SPDX-License-Identifier: Apache-2.0
#include "protocol/text.h"

#include <gtest/gtest.h>

#include <string>

namespace limn::protocol {
namespace {

TEST(Text, Utf8IsWellFormedOrRefused) {
  for (const char* good :
       {"", "a", "\x7F", "\xC2\x80", "\xED\x9F\xBF", "\xEF\xBF\xBF", "\xF4\x8F\xBF\xBF"})
    EXPECT_TRUE(isUtf8(good)) << good;
  const std::string bad[] = {
      "\x80",              // a continuation byte alone
      "\xC3",              // cut short
      "\xC0\xAF",          // overlong
      "\xE0\x80\xAF",      // overlong
      "\xED\xA0\x80",      // a surrogate
      "\xF4\x90\x80\x80",  // past U+10FFFF
      "\xFF",
      "a\xE2\x82"};
  for (const std::string& text : bad)
    EXPECT_FALSE(isUtf8(text));
}

TEST(Text, HasNoControlCharactersAndAtMostSoManyBytes) {
  EXPECT_TRUE(isText("Stanford B\xC3\xBCnny", 15));
  EXPECT_FALSE(isText("Stanford B\xC3\xBCnny", 14));
  EXPECT_TRUE(isText("", 0));
  EXPECT_TRUE(isText("\xC2\xA0", 2));
  for (const std::string& text :
       {std::string("\n"),
        std::string("\x1B[31m"),
        std::string(1, '\0'),
        std::string("\x7F"),
        std::string("\xC2\x85")})
    EXPECT_FALSE(isText(text, 100));
}

}  // namespace
}  // namespace limn::protocol
