// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/catalogue.h"
#include "server/transport/limits.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace limn {

struct HttpReply {
  int status = 200;
  std::string contentType = "application/json";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers = {};  // names in lower case
  bool close = false;                                             // the connection ends with it
};

/// The reply on the wire [RFC 9112].
[[nodiscard]] std::string httpText(const HttpReply& reply);

/// What somebody is told who is turned away, `why` in a line.
[[nodiscard]] HttpReply refusalReply(Refusal refusal, const std::string& why);

/// How often something took how long.
struct TimeCounts {
  static constexpr std::array kBoundsS = {0.001, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 1.0, 5.0};

  std::array<std::uint64_t, kBoundsS.size() + 1> counts{};  // up to each bound, and above
  double sumS = 0.0;

  void add(double seconds) {
    const auto at = std::ranges::lower_bound(kBoundsS, seconds) - kBoundsS.begin();
    ++counts[static_cast<std::size_t>(at)];
    sumS += seconds;
  }
};

/// What the server knows about itself, for /readyz and /metrics.
struct ServerStatus {
  std::string version;
  bool ready = true;  // store readable, not draining
  std::string notReadyBecause;
  std::size_t connections = 0;
  std::uint64_t connectionsTotal = 0;
  std::map<std::string, std::uint64_t> connectionsRefusedTotal;  // by Refusal
  std::map<std::string, std::uint64_t> connectionsClosedTotal;   // by Ending
  std::uint64_t sentBytesTotal = 0;
  std::uint64_t sentMessagesTotal = 0;
  std::uint64_t receivedMessagesTotal = 0;
  std::uint64_t posesTotal = 0;
  std::uint64_t posesReplacedTotal = 0;
  std::size_t sessionBytes = 0;
  std::size_t modelBytes = 0;
  std::size_t modelsLoaded = 0;
  std::size_t targetCacheBytes = 0;
  std::uint64_t targetSetsComputedTotal = 0;
  std::uint64_t targetCacheHitsTotal = 0;
  std::size_t tasksPending = 0;
  std::uint64_t preparationsTotal = 0;
  std::uint64_t preparationsFailedTotal = 0;
  TimeCounts loopLag;  // how late the loop came to its ticks
  double uptimeSeconds = 0.0;
};

/// What of an upgrade to WebSocket is ours to check: values of its headers.
struct UpgradeRequest {
  std::string_view version;
  std::string_view key;
  std::string_view protocols;
};

/// Nothing, or why it is refused [RFC 6455, 4.2]: another version, a bad key, not our subprotocol.
[[nodiscard]] std::optional<HttpReply> refuseUpgrade(const UpgradeRequest& request);

/// GET /models, as commands.md has it: what a grant allows to be seen; nullptr: everything.
[[nodiscard]] std::string catalogueJson(
    const std::vector<CatalogueItem>& items,
    const Grant* grant = nullptr);

/// Answers GET of a path on the main port: /models, /livez, /readyz, /version; else 404.
[[nodiscard]] HttpReply routeMain(
    std::string_view path,
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items,
    const Grant* grant = nullptr);

/// The same for the metrics port: /metrics, /livez.
[[nodiscard]] HttpReply routeMetrics(
    std::string_view path,
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items);

}  // namespace limn
