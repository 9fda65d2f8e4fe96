// SPDX-License-Identifier: Apache-2.0
#include "client/net/server_url.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(ServerUrl, ReadsHostPortAndPath) {
  const auto plain = parseServerUrl("ws://127.0.0.1:8600");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->host, "127.0.0.1");
  EXPECT_EQ(plain->port, 8600);
  EXPECT_EQ(plain->path, "/");
  EXPECT_FALSE(plain->tls);
  const auto secure = parseServerUrl("wss://example.org/limn/1");
  ASSERT_TRUE(secure);
  EXPECT_EQ(secure->port, 443);
  EXPECT_EQ(secure->path, "/limn/1");
  EXPECT_TRUE(secure->tls);
  const auto six = parseServerUrl("ws://[::1]:9000/");
  ASSERT_TRUE(six);
  EXPECT_EQ(six->host, "::1");
  EXPECT_EQ(six->port, 9000);
  EXPECT_EQ(six->text(), "ws://[::1]:9000");
  EXPECT_EQ(parseServerUrl("ws://host")->port, 80);
}

TEST(ServerUrl, RefusesEverythingElseWithAnExample) {
  for (const char* url : {"",           "host:1",        "http://host:1", "ws://",
                          "ws://:1",    "ws://h:",       "ws://h:0",      "ws://h:65536",
                          "ws://h:1x",  "ws://[::1",     "ws://[::1]x",   "ws://[::1]:",
                          "ws://[[c]",  "ws://[host]:1", "ws://h[:1",     "ws://a b:1",
                          "ws://u@h:1", "ws://h:1#x",    "ws://h\n:1",    "ws://h:-1"}) {
    const auto parsed = parseServerUrl(url);
    ASSERT_FALSE(parsed) << url;
    EXPECT_NE(parsed.error().message.find("ws://127.0.0.1:8600"), std::string::npos) << url;
  }
}

}  // namespace
}  // namespace limn
