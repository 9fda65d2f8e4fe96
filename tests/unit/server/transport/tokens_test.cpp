// SPDX-License-Identifier: Apache-2.0
#include "server/transport/tokens.h"

#include <gtest/gtest.h>

#include <string>

namespace limn {
namespace {

const TokenKey kKey = {"main", "0123456789abcdef0123456789abcdef"};
const TokenKey kOther = {"other", "fedcba9876543210fedcba9876543210"};
constexpr std::int64_t kNowS = 1'800'000'000;

std::string goodToken() {
  return signToken({{"ann", {"dragon", "team-*"}}, kNowS + 600}, kKey);
}

std::string whyNot(const std::string& token, const std::vector<TokenKey>& keys = {kOther, kKey}) {
  const auto grant = verifyToken(token, keys, kNowS);
  return grant ? "" : grant.error().message;
}

TEST(Tokens, AGoodOneSaysWhatItsBearerMaySee) {
  const auto grant = verifyToken(goodToken(), {kOther, kKey}, kNowS);
  ASSERT_TRUE(grant) << grant.error().message;
  EXPECT_EQ(grant->subject, "ann");
  EXPECT_TRUE(grant->allows("dragon"));
  EXPECT_FALSE(grant->allows("dragonfly"));
  EXPECT_TRUE(grant->allows("team-a"));
  EXPECT_TRUE(grant->allows("team-"));
  EXPECT_FALSE(grant->allows("tea"));
  EXPECT_FALSE(grant->allows(""));
}

// Made with another implementation (Python's hmac and base64), so that the format is the
// standard's.
TEST(Tokens, TakesWhatOtherLibrariesMake) {
  const std::string token =
      "eyJhbGciOiJIUzI1NiJ9.eyJleHAiOjE4MDAwMDA2MDAuMCwibW9kZWxzIjpbIioiXX0."
      "ezjqKPA67epzOooNjZhG3BFJ5zoi7s4nHjerC0eL96s";
  const auto grant = verifyToken(token, {kOther, kKey}, kNowS);
  ASSERT_TRUE(grant) << grant.error().message;
  EXPECT_TRUE(grant->allows("anything"));
}

TEST(Tokens, AnExpiredOneIsToldSo) {
  const std::string token = signToken({{"", {"*"}}, kNowS}, kKey);
  EXPECT_NE(whyNot(token).find("expired"), std::string::npos);
  EXPECT_TRUE(verifyToken(token, {kKey}, kNowS - 1));
}

TEST(Tokens, AnotherKeySignsForNobody) {
  EXPECT_NE(whyNot(goodToken(), {kOther}).find("not signed"), std::string::npos);
  EXPECT_NE(whyNot(goodToken(), {{"main", kOther.secret}}).find("not signed"), std::string::npos);
  EXPECT_NE(whyNot(goodToken(), {}).find("not signed"), std::string::npos);
}

TEST(Tokens, EveryChangeOfACharacterIsRefused) {
  const std::string token = goodToken();
  for (std::size_t i = 0; i < token.size(); ++i) {
    for (const char c : {'A', 'b', '-', '.', '=', ' ', '\0', '\xFF'}) {
      std::string changed = token;
      if (changed[i] == c) continue;
      changed[i] = c;
      EXPECT_FALSE(verifyToken(changed, {kKey}, kNowS)) << i << ' ' << c;
    }
    EXPECT_FALSE(verifyToken(token.substr(0, i), {kKey}, kNowS)) << i;
  }
  EXPECT_FALSE(verifyToken(token + "A", {kKey}, kNowS));
  EXPECT_FALSE(verifyToken(std::string(10'000, 'A'), {kKey}, kNowS));
}

TEST(Tokens, ATokenDoesNotChooseHowItIsChecked) {
  // {"alg":"none"} and no signature; {"alg":"HS512"}.
  const std::string rest = goodToken().substr(goodToken().find('.'));
  EXPECT_NE(whyNot("eyJhbGciOiJub25lIn0" + rest), "");
  EXPECT_NE(whyNot("eyJhbGciOiJub25lIn0" + rest.substr(0, rest.rfind('.') + 1)), "");
  EXPECT_NE(whyNot("eyJhbGciOiJIUzUxMiJ9" + rest).find("HS256"), std::string::npos);
}

TEST(TokenKeys, AreOneALine) {
  const auto keys = parseTokenKeys(
      "# ours\r\n\nmain 0123456789abcdef0123456789abcdef\r\nother "
      "fedcba9876543210fedcba9876543210");
  ASSERT_TRUE(keys) << keys.error().message;
  ASSERT_EQ(keys->size(), 2U);
  EXPECT_EQ((*keys)[0].id, "main");
  EXPECT_EQ((*keys)[1].secret, kOther.secret);
  for (const char* bad :
       {"",
        "# none\n",
        "main",
        "main short",
        "main 0123456789abcdef 0123456789abcdef",
        " 0123456789abcdef0123456789abcdef",
        "a 0123456789abcdef0123456789abcdef\na 0123456789abcdef0123456789abcdeX"}) {
    EXPECT_FALSE(parseTokenKeys(bad)) << bad;
  }
}

TEST(TokenKeys, AreMadeOfChance) {
  const auto one = makeTokenKey("main");
  const auto two = makeTokenKey("main");
  ASSERT_TRUE(one);
  ASSERT_TRUE(two);
  EXPECT_NE(*one, *two);
  EXPECT_TRUE(parseTokenKeys(*one));
  EXPECT_FALSE(makeTokenKey(""));
  EXPECT_FALSE(makeTokenKey("a b"));
  EXPECT_FALSE(makeTokenKey("#a"));
}

}  // namespace
}  // namespace limn
