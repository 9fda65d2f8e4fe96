// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/catalogue.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

struct HttpReply {
  int status = 200;
  std::string contentType = "application/json";
  std::string body;
};

/// What the server knows about itself, for /readyz and /metrics.
struct ServerStatus {
  std::string version;
  bool ready = true;  // store readable, not draining
  std::string notReadyBecause;
  std::size_t connections = 0;
  std::uint64_t connectionsTotal = 0;
  std::uint64_t connectionsRefusedTotal = 0;
  std::uint64_t sentBytesTotal = 0;
  std::uint64_t sentMessagesTotal = 0;
  std::uint64_t receivedMessagesTotal = 0;
  std::size_t sessionBytes = 0;
  std::size_t modelBytes = 0;
  std::size_t modelsLoaded = 0;
  std::size_t targetCacheBytes = 0;
  std::uint64_t targetSetsComputedTotal = 0;
  std::uint64_t targetCacheHitsTotal = 0;
  std::size_t tasksPending = 0;
  std::uint64_t preparationsTotal = 0;
  std::uint64_t preparationsFailedTotal = 0;
  double uptimeSeconds = 0.0;
};

/// GET /models, as commands.md has it.
[[nodiscard]] std::string catalogueJson(const std::vector<CatalogueItem>& items);

/// Prometheus text of what is known: base units, no labels per client.
[[nodiscard]] std::string metricsText(
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items);

/// Answers GET of a path on the main port: /models, /livez, /readyz, /version; else 404.
[[nodiscard]] HttpReply routeMain(
    std::string_view path,
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items);

/// The same for the metrics port: /metrics, /livez.
[[nodiscard]] HttpReply routeMetrics(
    std::string_view path,
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items);

}  // namespace limn
