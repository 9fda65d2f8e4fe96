// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/import/text_scanner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace limn::import {
namespace {

TEST(ParseNumber, ReadsWhatWritersWrite) {
  const auto value = [](std::string_view token) { return parseNumber(token).value; };
  EXPECT_EQ(value("1"), 1.0);
  EXPECT_EQ(value("+1.5"), 1.5);
  EXPECT_EQ(value("-.5"), -0.5);
  EXPECT_EQ(value("1."), 1.0);
  EXPECT_EQ(value("1E3"), 1000.0);
  EXPECT_EQ(value("500000.123456789"), 500000.123456789);
  EXPECT_EQ(value("1e-400"), 0.0);
  EXPECT_TRUE(std::isnan(value("nan")));
  EXPECT_TRUE(std::isinf(value("-inf")));
  EXPECT_TRUE(std::isnan(value("1.#QNAN")));
}

TEST(ParseNumber, TellsTooLargeFromMalformed) {
  EXPECT_EQ(parseNumber("1e400").status, Number::Status::kTooLarge);
  EXPECT_EQ(parseNumber("-1e400").status, Number::Status::kTooLarge);
  for (const char* token : {"", "+", "-", "x", "1x", "1,5", "0x10", "1e", "--1", "1.2.3"}) {
    EXPECT_EQ(parseNumber(token).status, Number::Status::kMalformed) << token;
  }
}

TEST(TextScanner, CountsLinesWhateverEndsThem) {
  for (const std::string newline : {"\n", "\r\n", "\r"}) {
    const std::string text = "a b" + newline + newline + "c";
    TextScanner scanner(text);
    EXPECT_EQ(scanner.token(), "a");
    EXPECT_EQ(scanner.tokenOnLine(), "b");
    EXPECT_EQ(scanner.tokenOnLine(), "");
    EXPECT_EQ(scanner.line(), 1U);
    EXPECT_EQ(scanner.token(), "c");
    EXPECT_EQ(scanner.line(), 3U);
    EXPECT_EQ(scanner.token(), "");
    EXPECT_TRUE(scanner.atEnd());
  }
}

TEST(TextScanner, JoinsContinuedLinesAndSkipsComments) {
  TextScanner scanner(
      "a# b\nc \\\r\n d\\\ne # f \\\ng",
      {.hashComments = true, .backslashContinuation = true});
  EXPECT_EQ(scanner.tokenOnLine(), "a");
  EXPECT_EQ(scanner.tokenOnLine(), "");
  EXPECT_TRUE(scanner.nextLine());
  EXPECT_EQ(scanner.tokenOnLine(), "c");
  EXPECT_EQ(scanner.tokenOnLine(), "d");
  EXPECT_EQ(scanner.tokenOnLine(), "e");
  EXPECT_EQ(scanner.tokenOnLine(), "");
  EXPECT_TRUE(scanner.nextLine());
  EXPECT_EQ(scanner.tokenOnLine(), "g");
  EXPECT_FALSE(scanner.nextLine());
}

}  // namespace
}  // namespace limn::import
