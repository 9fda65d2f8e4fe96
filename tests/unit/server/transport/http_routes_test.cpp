// SPDX-License-Identifier: Apache-2.0
#include "server/transport/http_routes.h"

#include "server/transport/metrics.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sstream>

namespace limn {
namespace {

std::vector<CatalogueItem> items() {
  CatalogueItem ready;
  ready.name = "dragon \"x\"";
  ready.state = protocol::ModelState::kReady;
  ready.progress = 1.0;
  ready.asset = Sha256Digest{0xAB};
  ready.vertices = 10;
  ready.faces = 16;
  ready.bytes = 12345;
  ready.center = {1.0, 2.0, 3.0};
  ready.radius = 4.5;
  CatalogueItem failed;
  failed.name = "zebra";
  failed.state = protocol::ModelState::kFailed;
  failed.reason = "no faces";
  return {ready, failed};
}

TEST(HttpRoutes, TheCatalogueHasEveryKeyOfTheContract) {
  const HttpReply reply = routeMain("/models", {}, items());
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(reply.contentType, "application/json");
  const auto json = nlohmann::json::parse(reply.body);
  ASSERT_EQ(json.size(), 2U);
  for (const char* key :
       {"name",
        "state",
        "progress",
        "reason",
        "asset",
        "vertices",
        "faces",
        "bytes",
        "center",
        "radius",
        "has_hull"}) {
    EXPECT_TRUE(json[0].contains(key)) << key;
    EXPECT_TRUE(json[1].contains(key)) << key;
  }
  EXPECT_EQ(json[0]["name"], "dragon \"x\"");
  EXPECT_EQ(json[0]["state"], "ready");
  EXPECT_EQ(json[0]["asset"].get<std::string>().size(), 64U);
  EXPECT_EQ(json[0]["center"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(json[1]["state"], "failed");
  EXPECT_EQ(json[1]["reason"], "no faces");
  EXPECT_TRUE(json[1]["asset"].is_null());
}

TEST(HttpRoutes, AnUpgradeThatIsNoneIsToldWhatToSend) {
  const std::string key = "dGhlIHNhbXBsZSBub25jZQ==";
  EXPECT_FALSE(refuseUpgrade({"13", key, "limn.1"}));
  EXPECT_FALSE(refuseUpgrade({"13", key, "other ,  limn.1"}));
  EXPECT_EQ(refuseUpgrade({"8", key, "limn.1"})->status, 426);
  EXPECT_EQ(refuseUpgrade({"", key, "limn.1"})->status, 426);
  EXPECT_EQ(refuseUpgrade({"13", key, ""})->status, 400);
  EXPECT_EQ(refuseUpgrade({"13", key, "limn.10"})->status, 400);
  EXPECT_EQ(refuseUpgrade({"13", key, "limn"})->status, 400);
  for (const char* bad :
       {"", "dGhlIHNhbXBsZSBub25jZQ=", "dGhlIHNhbXBsZSBub25jZQ===", "dGhl*HNhbXBsZSBub25jZQ=="}) {
    EXPECT_EQ(refuseUpgrade({"13", bad, "limn.1"})->status, 400) << bad;
  }
}

TEST(HttpRoutes, ARefusalSaysWhyAndWhenToComeAgain) {
  const HttpReply full = refusalReply(Refusal::kTotal, "too many clients");
  EXPECT_EQ(full.status, 503);
  EXPECT_EQ(full.body, "too many clients\n");
  EXPECT_EQ(full.headers.at(0).first, "retry-after");
  EXPECT_TRUE(full.close);
  EXPECT_EQ(refusalReply(Refusal::kAddress, "").status, 429);
  EXPECT_EQ(refusalReply(Refusal::kToken, "").status, 401);
  EXPECT_EQ(refusalReply(Refusal::kOrigin, "").status, 403);
}

TEST(HttpRoutes, AnEmptyCatalogueIsAList) {
  EXPECT_EQ(routeMain("/models", {}, {}).body, "[]\n");
}

TEST(HttpRoutes, ReadinessSaysWhyNot) {
  ServerStatus status;
  EXPECT_EQ(routeMain("/readyz", status, {}).status, 200);
  status.ready = false;
  status.notReadyBecause = "draining";
  EXPECT_EQ(routeMain("/readyz", status, {}).status, 503);
  EXPECT_EQ(routeMain("/readyz", status, {}).body, "draining\n");
  EXPECT_EQ(routeMain("/livez", status, {}).status, 200) << "alive all the same";
}

TEST(HttpRoutes, MetricsAreOnTheirOwnListener) {
  EXPECT_EQ(routeMain("/metrics", {}, {}).status, 404);
  EXPECT_EQ(routeMetrics("/models", {}, {}).status, 404);
  EXPECT_EQ(routeMetrics("/metrics", {}, {}).status, 200);
}

TEST(HttpRoutes, EveryMetricIsDescribedAndHasANumber) {
  ServerStatus status;
  status.connections = 3;
  status.sentBytesTotal = 1'000'000'000'000ULL;
  std::istringstream lines(metricsText(status, items()));
  std::string line;
  std::string described;
  std::size_t samples = 0;
  while (std::getline(lines, line)) {
    if (line.starts_with("# HELP ")) {
      described = line.substr(7, line.find(' ', 7) - 7);
      continue;
    }
    if (line.starts_with("# TYPE ")) {
      EXPECT_TRUE(line.starts_with("# TYPE " + described + " ")) << line;
      continue;
    }
    ++samples;
    EXPECT_TRUE(line.starts_with(described)) << line;
    std::size_t used = 0;
    const std::string number = line.substr(line.rfind(' ') + 1);
    static_cast<void>(std::stod(number, &used));
    EXPECT_EQ(used, number.size()) << line;
  }
  EXPECT_GT(samples, 15U);
}

}  // namespace
}  // namespace limn
