// SPDX-License-Identifier: Apache-2.0
#include "server/transport/access.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(AccessRules, WithoutTokensEverybodyMayIn) {
  EXPECT_FALSE(AccessRules{}.guarded());
  const auto grant = AccessRules{}.admit("", 0);
  ASSERT_TRUE(grant);
  EXPECT_EQ(*grant, nullptr);
}

TEST(AccessRules, ATokenMustMatchWhole) {
  AccessRules rules;
  rules.tokens = {"0123456789abcdef", "another-token-of-ours"};
  EXPECT_TRUE(rules.admit("Bearer 0123456789abcdef", 0));
  EXPECT_TRUE(rules.admit("Bearer another-token-of-ours", 0));
  for (const char* wrong :
       {"",
        "0123456789abcdef",
        "Bearer ",
        "Bearer 0123456789abcde",
        "Bearer 0123456789abcdef ",
        "Bearer 0123456789abcdeF",
        "Basic 0123456789abcdef"}) {
    EXPECT_FALSE(rules.admit(wrong, 0)) << wrong;
  }
}

TEST(AccessRules, ASignedTokenBringsItsRights) {
  AccessRules rules;
  rules.keys = {{"main", "0123456789abcdef0123456789abcdef"}};
  const std::string token = signToken({{"ann", {"dragon"}}, 1000}, rules.keys[0]);
  const auto grant = rules.admit("Bearer " + token, 999);
  ASSERT_TRUE(grant);
  ASSERT_NE(*grant, nullptr);
  EXPECT_TRUE((*grant)->allows("dragon"));
  EXPECT_FALSE((*grant)->allows("bunny"));
  EXPECT_FALSE(rules.admit("Bearer " + token, 1000));
  EXPECT_FALSE(rules.admit("", 0));
  rules.tokens = {"0123456789abcdef"};
  EXPECT_EQ(*rules.admit("Bearer 0123456789abcdef", 0), nullptr) << "everything";
}

TEST(AccessRules, PagesOfOtherSitesAreRefused) {
  AccessRules rules;
  EXPECT_TRUE(rules.allowsOrigin("", "host:8600")) << "no browser";
  EXPECT_TRUE(rules.allowsOrigin("http://LocalHost:3000", "localhost:8600"));
  EXPECT_TRUE(rules.allowsOrigin("http://127.0.0.1:3000", "127.0.0.1:8600"));
  EXPECT_TRUE(rules.allowsOrigin("http://[::1]:3000", "[::1]:8600"));
  EXPECT_FALSE(rules.allowsOrigin("http://127.0.0.1:3000", "192.0.2.1:8600"));
  EXPECT_FALSE(rules.allowsOrigin("http://host:3000", "host:8600")) << "whoever owns the name";
  EXPECT_FALSE(rules.allowsOrigin("https://evil.example", "host:8600"));
  EXPECT_FALSE(rules.allowsOrigin("null", "host:8600"));
  EXPECT_FALSE(rules.allowsOrigin("://", ""));
  rules.origins = {"viewer.example"};
  EXPECT_TRUE(rules.allowsOrigin("https://viewer.example", "host:8600"));
  EXPECT_FALSE(rules.allowsOrigin("https://other.example", "host:8600"));
  EXPECT_FALSE(rules.allowsOrigin("https://viewer.example.evil.example", "host:8600"));
}

TEST(ParseTokens, TakesOneALineAndNamesTheBadOne) {
  const auto tokens = parseTokens("# ours\n0123456789abcdef\r\n\nfedcba9876543210");
  ASSERT_TRUE(tokens);
  EXPECT_EQ(*tokens, (std::vector<std::string>{"0123456789abcdef", "fedcba9876543210"}));
  EXPECT_FALSE(parseTokens(""));
  EXPECT_FALSE(parseTokens("# nothing\n"));
  const auto bad = parseTokens("0123456789abcdef\nshort\n");
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().message.find("line 2"), std::string::npos);
  EXPECT_FALSE(parseTokens("0123456789 abcdef"));
}

TEST(ParseListenAddress, TakesHostsWithPorts) {
  const auto v4 = parseListenAddress("127.0.0.1:8600");
  ASSERT_TRUE(v4);
  EXPECT_EQ(v4->host, "127.0.0.1");
  EXPECT_EQ(v4->port, 8600);
  EXPECT_FALSE(v4->ipv6);
  EXPECT_EQ(parseListenAddress("localhost:0")->host, "127.0.0.1");
  EXPECT_EQ(parseListenAddress(":80")->host, "");
  const auto v6 = parseListenAddress("[::1]:8600");
  ASSERT_TRUE(v6);
  EXPECT_EQ(v6->host, "::1");
  EXPECT_TRUE(v6->ipv6);
  for (const char* bad :
       {"",
        "8600",
        "127.0.0.1",
        "127.0.0.1:",
        "127.0.0.1:x",
        "127.0.0.1:70000",
        "1.2.3:80",
        "[::1:80",
        "::1:80",
        "example.org:80",
        "127.0.0.1:-1"}) {
    EXPECT_FALSE(parseListenAddress(bad)) << bad;
  }
}

}  // namespace
}  // namespace limn
