// SPDX-License-Identifier: Apache-2.0
#include "server/transport/access.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(AccessRules, WithoutTokensEverybodyMayIn) {
  EXPECT_TRUE(AccessRules{}.hasToken(""));
}

TEST(AccessRules, ATokenMustMatchWhole) {
  AccessRules rules;
  rules.tokens = {"0123456789abcdef", "another-token-of-ours"};
  EXPECT_TRUE(rules.hasToken("Bearer 0123456789abcdef"));
  EXPECT_TRUE(rules.hasToken("Bearer another-token-of-ours"));
  for (const char* wrong :
       {"",
        "0123456789abcdef",
        "Bearer ",
        "Bearer 0123456789abcde",
        "Bearer 0123456789abcdef ",
        "Bearer 0123456789abcdeF",
        "Basic 0123456789abcdef"}) {
    EXPECT_FALSE(rules.hasToken(wrong)) << wrong;
  }
}

TEST(AccessRules, PagesOfOtherSitesAreRefused) {
  AccessRules rules;
  EXPECT_TRUE(rules.allowsOrigin("", "host:8600")) << "no browser";
  EXPECT_TRUE(rules.allowsOrigin("http://Host:3000", "host:8600")) << "our own host";
  EXPECT_FALSE(rules.allowsOrigin("https://evil.example", "host:8600"));
  EXPECT_FALSE(rules.allowsOrigin("https://host.evil.example", "host:8600"));
  EXPECT_FALSE(rules.allowsOrigin("null", "host:8600"));
  rules.origins = {"viewer.example"};
  EXPECT_TRUE(rules.allowsOrigin("https://viewer.example", "host:8600"));
  EXPECT_FALSE(rules.allowsOrigin("https://other.example", "host:8600"));
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

TEST(ConnectionCounter, KeepsToBothLimits) {
  AccessRules rules;
  rules.maxClients = 3;
  rules.maxClientsPerAddress = 2;
  ConnectionCounter counter;
  EXPECT_TRUE(counter.enter("a", rules));
  EXPECT_TRUE(counter.enter("a", rules));
  EXPECT_FALSE(counter.enter("a", rules));
  EXPECT_TRUE(counter.enter("b", rules));
  EXPECT_FALSE(counter.enter("c", rules));
  counter.leave("a");
  EXPECT_TRUE(counter.enter("c", rules));
  counter.leave("never");
  EXPECT_EQ(counter.total(), 3U);
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
