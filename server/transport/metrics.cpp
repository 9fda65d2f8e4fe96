// SPDX-License-Identifier: Apache-2.0
#include "server/transport/metrics.h"

#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include <array>
#include <limits>
#include <map>

namespace limn {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricType;

constexpr std::array kStateNames = {"queued", "preparing", "ready", "failed"};

/// Metrics as prometheus-cpp takes them, from numbers that are counted elsewhere.
class Families {
 public:
  prometheus::MetricFamily& add(const char* name, const char* help, MetricType type) {
    return families_.emplace_back(prometheus::MetricFamily{name, help, type, {}});
  }

  void gauge(const char* name, const char* help, double value) {
    add(name, help, MetricType::Gauge).metric.emplace_back().gauge.value = value;
  }

  void counter(const char* name, const char* help, std::uint64_t value) {
    add(name, help, MetricType::Counter).metric.emplace_back().counter.value =
        static_cast<double>(value);
  }

  void counters(
      const char* name,
      const char* help,
      const char* label,
      const std::map<std::string, std::uint64_t>& values) {
    prometheus::MetricFamily& family = add(name, help, MetricType::Counter);
    for (const auto& [key, value] : values) {
      ClientMetric metric;
      metric.label = {{label, key}};
      metric.counter.value = static_cast<double>(value);
      family.metric.push_back(metric);
    }
  }

  void times(const char* name, const char* help, const TimeCounts& times) {
    auto& histogram = add(name, help, MetricType::Histogram).metric.emplace_back().histogram;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < times.counts.size(); ++i) {
      sum += times.counts[i];
      const double bound = i < TimeCounts::kBoundsS.size()
                               ? TimeCounts::kBoundsS[i]
                               : std::numeric_limits<double>::infinity();
      histogram.bucket.push_back({sum, bound});
    }
    histogram.sample_count = sum;
    histogram.sample_sum = times.sumS;
  }

  [[nodiscard]] std::string text() const {
    return prometheus::TextSerializer().Serialize(families_);
  }

 private:
  std::vector<prometheus::MetricFamily> families_;
};

}  // namespace

std::string metricsText(const ServerStatus& s, const std::vector<CatalogueItem>& items) {
  Families out;
  out.gauge("limn_uptime_seconds", "Time since the start.", s.uptimeSeconds);
  out.gauge("limn_ready", "1 when new clients are welcome.", s.ready ? 1 : 0);
  out.gauge("limn_connections", "Open WebSocket connections.", static_cast<double>(s.connections));
  out.counter("limn_connections_total", "WebSocket connections accepted.", s.connectionsTotal);
  out.counters(
      "limn_connections_refused_total",
      "Connections turned away.",
      "reason",
      s.connectionsRefusedTotal);
  out.counters(
      "limn_connections_closed_total",
      "WebSocket connections that ended.",
      "reason",
      s.connectionsClosedTotal);
  out.counter("limn_sent_bytes_total", "Payload of WebSocket messages sent.", s.sentBytesTotal);
  out.counter("limn_sent_messages_total", "WebSocket messages sent.", s.sentMessagesTotal);
  out.counter(
      "limn_received_messages_total",
      "WebSocket messages received.",
      s.receivedMessagesTotal);
  out.counter("limn_poses_total", "Poses received.", s.posesTotal);
  out.counter(
      "limn_poses_replaced_total",
      "Poses that a newer one replaced before it was their turn.",
      s.posesReplacedTotal);
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
  prometheus::MetricFamily& models =
      out.add("limn_models", "Models of the catalogue.", MetricType::Gauge);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    ClientMetric metric;
    metric.label = {{"state", kStateNames[i]}};
    metric.gauge.value = static_cast<double>(counts[i]);
    models.metric.push_back(metric);
  }
  out.times("limn_loop_lag_seconds", "How late the loop came to its ticks.", s.loopLag);
  return out.text();
}

}  // namespace limn
