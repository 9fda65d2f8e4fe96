// SPDX-License-Identifier: Apache-2.0
#include "client/load/report.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace limn::load {
namespace {

constexpr std::size_t kMaxErrorTexts = 32;

struct Statistic {
  const char* name;
  double fraction;
};

constexpr std::array<Statistic, 4> kStatistics{
    {{"p50", 0.50}, {"p95", 0.95}, {"p99", 0.99}, {"max", 1.0}}};

std::array<std::pair<const char*, const Latencies*>, 4> latenciesOf(const Counters& counters) {
  return {{
      {"connect", &counters.connect},
      {"base", &counters.base},
      {"pose_to_packet", &counters.poseToPacket},
      {"settled", &counters.settled},
  }};
}

double rounded(double value) {
  return std::round(value * 1000.0) / 1000.0;
}

}  // namespace

std::optional<double> Latencies::percentile(double fraction) const {
  if (samples_.empty()) return std::nullopt;
  const double rank = std::ceil(fraction * static_cast<double>(samples_.size()));
  const std::size_t index =
      std::min(samples_.size(), static_cast<std::size_t>(std::max(rank, 1.0))) - 1;
  std::vector<float> sorted = samples_;
  std::nth_element(
      sorted.begin(),
      sorted.begin() + static_cast<std::ptrdiff_t>(index),
      sorted.end());
  return sorted[index];
}

void Counters::note(const std::string& error) {
  const std::string text = error.substr(0, 200);
  if (errors.size() < kMaxErrorTexts || errors.contains(text)) {
    ++errors[text];
  } else {
    ++errors["other"];
  }
}

std::vector<std::string> missedThresholds(
    const std::map<std::string, double>& thresholds,
    const Counters& counters,
    const std::optional<ServerUsage>& server) {
  std::map<std::string, std::optional<double>> measured{
      {"failed", static_cast<double>(counters.failed)},
      {"dropped", static_cast<double>(counters.dropped)},
      {"decode_errors", static_cast<double>(counters.decodeErrors)},
      {"server_rss_growth_mib", std::nullopt},
      {"server_cpu_seconds", std::nullopt},
  };
  if (server) {
    measured["server_rss_growth_mib"] = server->rssMibPeak - server->rssMibBefore;
    measured["server_cpu_seconds"] = server->cpuSeconds;
  }
  for (const auto& [name, latencies] : latenciesOf(counters)) {
    for (const Statistic& statistic : kStatistics) {
      measured[std::string(name) + "_" + statistic.name + "_ms"] =
          latencies->percentile(statistic.fraction);
    }
  }
  std::vector<std::string> missed;
  for (const auto& [name, bound] : thresholds) {
    const auto found = measured.find(name);
    const nlohmann::json shownBound = bound;
    if (found == measured.end() || !found->second) {
      missed.push_back(name + ": not measured, the bound is " + shownBound.dump());
    } else if (!(*found->second <= bound)) {
      const nlohmann::json shown = rounded(*found->second);
      missed.push_back(name + ": " + shown.dump() + ", the bound is " + shownBound.dump());
    }
  }
  return missed;
}

std::string reportJson(const Run& run, const std::vector<std::string>& missed) {
  const Counters& counters = run.counters;
  const std::optional<ServerUsage>& server = run.server;
  nlohmann::ordered_json report;
  report["clients"] = {
      {"asked", counters.asked},
      {"connected", counters.connected},
      {"failed", counters.failed},
      {"dropped", counters.dropped},
      {"reconnects", counters.reconnects},
      {"resumed", counters.resumed}};
  report["seconds"] = rounded(run.seconds);
  report["own_cpu_seconds"] = rounded(run.ownCpuSeconds);
  report["bytes_received"] = counters.bytesReceived;
  report["messages"] = counters.messages;
  report["poses_sent"] = counters.posesSent;
  report["splits_decoded"] = counters.splitsDecoded;
  report["decode_errors"] = counters.decodeErrors;
  for (const auto& [name, latencies] : latenciesOf(counters)) {
    nlohmann::ordered_json& entry = report["latency_ms"][name];
    for (const Statistic& statistic : kStatistics) {
      const auto value = latencies->percentile(statistic.fraction);
      entry[statistic.name] = value ? nlohmann::ordered_json(rounded(*value)) : nullptr;
    }
    entry["samples"] = latencies->count();
  }
  for (const Statistic& statistic : kStatistics) {
    const auto value = counters.poseToPacketBytes.percentile(statistic.fraction);
    report["pose_to_packet_bytes"][statistic.name] =
        value ? nlohmann::ordered_json(rounded(*value)) : nullptr;
  }
  if (server) {
    report["server"] = {
        {"rss_mib_before", rounded(server->rssMibBefore)},
        {"rss_mib_peak", rounded(server->rssMibPeak)},
        {"cpu_seconds", rounded(server->cpuSeconds)}};
  } else {
    report["server"] = nullptr;
  }
  report["errors"] = counters.errors;
  report["passed"] = missed.empty();
  report["failures"] = missed;
  // Peers' texts may hold anything; invalid UTF-8 is replaced, not thrown about.
  return report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace limn::load
