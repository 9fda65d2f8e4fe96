// SPDX-License-Identifier: Apache-2.0
#include "client/load/report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace limn::load {
namespace {

TEST(Latencies, PercentilesAreTheNearestRank) {
  Latencies latencies;
  EXPECT_FALSE(latencies.percentile(0.5));
  for (int i = 100; i >= 1; --i)
    latencies.add(i);
  EXPECT_EQ(latencies.percentile(0.50), 50.0);
  EXPECT_EQ(latencies.percentile(0.99), 99.0);
  EXPECT_EQ(latencies.percentile(1.0), 100.0);
}

TEST(LoadReport, AThresholdIsMissedWhenExceededOrNotMeasured) {
  Counters counters;
  counters.failed = 1;
  counters.poseToPacket.add(20.0);
  const auto misses = [&](const char* name, double bound, std::optional<ServerUsage> server = {}) {
    return missedThresholds({{name, bound}}, counters, server).size();
  };
  EXPECT_EQ(misses("pose_to_packet_p99_ms", 20.0), 0u);
  EXPECT_EQ(misses("pose_to_packet_p99_ms", 19.0), 1u);
  EXPECT_EQ(misses("settled_p50_ms", 1e9), 1u);
  EXPECT_EQ(misses("failed", 0.0), 1u);
  EXPECT_EQ(misses("failed", 1.0), 0u);
  EXPECT_EQ(misses("server_rss_growth_mib", 10.0), 1u);
  EXPECT_EQ(misses("server_rss_growth_mib", 10.0, ServerUsage{5, 14, 0}), 0u);
  EXPECT_EQ(misses("server_rss_growth_mib", 8.0, ServerUsage{5, 14, 0}), 1u);
}

TEST(LoadReport, HasTheKeysOfItsContract) {
  Counters counters;
  counters.note(std::string("bad \xff text"));
  const auto json =
      nlohmann::json::parse(reportJson({counters, ServerUsage{1, 2, 3}, 4.0, 1.5}, {"missed"}));
  for (const char* key : {"asked", "connected", "failed", "dropped"}) {
    EXPECT_TRUE(json["clients"].contains(key)) << key;
  }
  for (const char* key :
       {"bytes_received", "messages", "decode_errors", "own_cpu_seconds", "passed", "failures"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* latency : {"connect", "base", "pose_to_packet", "settled"}) {
    for (const char* statistic : {"p50", "p95", "p99", "max"}) {
      ASSERT_TRUE(json["latency_ms"][latency].contains(statistic)) << latency << statistic;
      EXPECT_TRUE(json["latency_ms"][latency][statistic].is_null()) << latency << statistic;
    }
  }
  for (const char* key : {"rss_mib_before", "rss_mib_peak", "cpu_seconds"}) {
    EXPECT_TRUE(json["server"].contains(key)) << key;
  }
  EXPECT_EQ(json["passed"], false);
}

TEST(LoadReport, ErrorTextsStayFew) {
  Counters counters;
  for (int i = 0; i < 1000; ++i)
    counters.note("error " + std::to_string(i));
  EXPECT_EQ(counters.errors.size(), 33u);
  EXPECT_EQ(counters.errors.at("other"), 1000u - 32u);
}

}  // namespace
}  // namespace limn::load
