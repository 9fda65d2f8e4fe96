// SPDX-License-Identifier: Apache-2.0
#include "server/transport/http_routes.h"

#include <nlohmann/json.hpp>

#include <array>

namespace limn {
namespace {

using nlohmann::json;

constexpr std::array kStateNames = {"queued", "preparing", "ready", "failed"};

std::string dump(const json& value) {
  return value.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

HttpReply text(int status, std::string body) {
  return {status, "text/plain; charset=utf-8", std::move(body)};
}

HttpReply notFound(std::string_view path, const char* known) {
  return text(404, "no " + std::string(path.substr(0, 100)) + " here; there is " + known + "\n");
}

class MetricsWriter {
 public:
  void gauge(const char* name, const char* help, double value) {
    write(name, help, "gauge", value);
  }

  void counter(const char* name, const char* help, std::uint64_t value) {
    write(name, help, "counter", static_cast<double>(value));
  }

  void header(const char* name, const char* help, const char* type) {
    out_ += std::string("# HELP ") + name + " " + help + "\n# TYPE " + name + " " + type + "\n";
  }

  void sample(const std::string& series, double value) {
    out_ += series + " " + json(value).dump() + "\n";
  }

  std::string take() { return std::move(out_); }

 private:
  void write(const char* name, const char* help, const char* type, double value) {
    header(name, help, type);
    sample(name, value);
  }

  std::string out_;
};

}  // namespace

std::string catalogueJson(const std::vector<CatalogueItem>& items) {
  json list = json::array();
  for (const CatalogueItem& item : items) {
    json entry = {
        {"name", item.name},
        {"state", kStateNames[static_cast<std::size_t>(item.state)]},
        {"progress", item.progress},
        {"reason", item.reason},
        {"asset", item.asset ? json(toHex(*item.asset)) : json()},
        {"vertices", item.vertices},
        {"faces", item.faces},
        {"bytes", item.bytes},
        {"center", {item.center.x, item.center.y, item.center.z}},
        {"radius", item.radius},
        {"has_hull", item.hasHull}};
    list.push_back(std::move(entry));
  }
  return dump(list);
}

std::string metricsText(const ServerStatus& s, const std::vector<CatalogueItem>& items) {
  MetricsWriter out;
  out.gauge("limn_uptime_seconds", "Time since the start.", s.uptimeSeconds);
  out.gauge("limn_ready", "1 when new clients are welcome.", s.ready ? 1 : 0);
  out.gauge("limn_connections", "Open WebSocket connections.", static_cast<double>(s.connections));
  out.counter("limn_connections_total", "WebSocket connections accepted.", s.connectionsTotal);
  out.counter(
      "limn_connections_refused_total",
      "Connections turned away: limits, token, origin.",
      s.connectionsRefusedTotal);
  out.counter("limn_sent_bytes_total", "Payload of WebSocket messages sent.", s.sentBytesTotal);
  out.counter("limn_sent_messages_total", "WebSocket messages sent.", s.sentMessagesTotal);
  out.counter(
      "limn_received_messages_total",
      "WebSocket messages received.",
      s.receivedMessagesTotal);
  out.gauge("limn_session_bytes", "Memory of all sessions.", static_cast<double>(s.sessionBytes));
  out.gauge("limn_model_bytes", "Memory of loaded models.", static_cast<double>(s.modelBytes));
  out.gauge("limn_models_loaded", "Models in memory.", static_cast<double>(s.modelsLoaded));
  out.gauge(
      "limn_target_cache_bytes",
      "Memory of cached target sets.",
      static_cast<double>(s.targetCacheBytes));
  out.counter(
      "limn_target_sets_total",
      "Target sets computed on workers.",
      s.targetSetsComputedTotal);
  out.counter(
      "limn_target_cache_hits_total",
      "View cells found in the cache.",
      s.targetCacheHitsTotal);
  out.gauge(
      "limn_tasks_pending",
      "Work waiting for or on workers.",
      static_cast<double>(s.tasksPending));
  out.counter("limn_preparations_total", "Preparations finished.", s.preparationsTotal);
  out.counter("limn_preparations_failed_total", "Preparations failed.", s.preparationsFailedTotal);
  std::array<std::size_t, kStateNames.size()> counts{};
  for (const CatalogueItem& item : items)
    ++counts[static_cast<std::size_t>(item.state)];
  out.header("limn_models", "Models of the catalogue by state.", "gauge");
  for (std::size_t i = 0; i < counts.size(); ++i) {
    out.sample(
        std::string("limn_models{state=\"") + kStateNames[i] + "\"}",
        static_cast<double>(counts[i]));
  }
  return out.take();
}

HttpReply routeMain(
    std::string_view path,
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items) {
  if (path == "/models") return {200, "application/json", catalogueJson(items)};
  if (path == "/livez") return text(200, "ok\n");
  if (path == "/readyz") {
    return status.ready ? text(200, "ok\n") : text(503, status.notReadyBecause + "\n");
  }
  if (path == "/version") {
    return {200, "application/json", dump({{"name", "limn-server"}, {"version", status.version}})};
  }
  return notFound(path, "/models, /livez, /readyz and /version");
}

HttpReply routeMetrics(
    std::string_view path,
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items) {
  if (path == "/metrics") {
    return {200, "text/plain; version=0.0.4; charset=utf-8", metricsText(status, items)};
  }
  if (path == "/livez") return text(200, "ok\n");
  return notFound(path, "/metrics and /livez");
}

}  // namespace limn
