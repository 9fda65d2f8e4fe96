// SPDX-License-Identifier: Apache-2.0
#include "client/apps/load_run.h"

#include "client/apps/load_server_usage.h"
#include "client/net/load_connections.h"

#include "protocol/limits.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <functional>
#include <queue>
#include <unordered_map>
#include <utility>
#include <vector>

namespace limn::load {
namespace {

constexpr double kSampleIntervalMs = 200.0;
constexpr double kProgressIntervalMs = 1000.0;
constexpr double kGoodbyeMs = 2000.0;  // for closing handshakes after the last phase
// A link slower than its data is paused for at least this long, so that the generator is not busy
// switching it on and off.
constexpr double kShortestPauseMs = 5.0;

/// Joins light clients to connections and to the clock.
/// Processor time of this process so far.
double ownCpuSeconds() {
  timespec used{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

class Runner : public LoadConnections::Listener {
 public:
  Runner(const Script& script, const RunOptions& options) : script_(script), options_(options) {}

  Result<Run> run() {
    makeClients();
    LoadConnections::Options network;
    network.url = options_.url;
    network.token = options_.token;
    network.caFile = options_.caFile;
    network.maxConnections = clients_.size();
    network.maxMessageBytes = limits::kMaxServerMessageBytes;
    network.subprotocol = limits::kSubprotocol;
    auto connections = LoadConnections::create(network, *this);
    if (!connections) return tl::unexpected(connections.error());
    connections_ = std::move(*connections);

    std::optional<ServerWatch> watch;
    if (options_.server) watch = ServerWatch::start(*options_.server);
    double nextSampleMs = 0.0;
    double nextProgressMs = kProgressIntervalMs;
    while (nowMs() < endMs_ || (!slots_.empty() && nowMs() < endMs_ + kGoodbyeMs)) {
      const double now = nowMs();
      tickDue(now);
      resumeDue(now);
      if (now >= nextSampleMs) {
        if (watch) watch->sample();
        nextSampleMs = now + kSampleIntervalMs;
      }
      if (now >= nextProgressMs) {
        if (options_.progress) options_.progress(now / 1000.0, counters_);
        nextProgressMs = now + kProgressIntervalMs;
      }
      double dueMs = std::min(nextSampleMs, nextProgressMs);
      if (!due_.empty()) dueMs = std::min(dueMs, due_.top().first);
      if (!paused_.empty()) dueMs = std::min(dueMs, paused_.top().first);
      connections_->service(std::max(dueMs - nowMs(), 0.0));
      if (due_.empty() && slots_.empty()) break;
    }
    if (watch) watch->sample();
    Run result;
    result.seconds = nowMs() / 1000.0;
    result.ownCpuSeconds = ownCpuSeconds();
    result.counters = std::move(counters_);
    if (watch) result.server = watch->usage();
    connections_.reset();
    return result;
  }

 private:
  using Id = LoadConnections::Id;
  using Due = std::pair<double, std::size_t>;  // time, client
  using DueQueue = std::priority_queue<Due, std::vector<Due>, std::greater<>>;

  [[nodiscard]] double nowMs() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
        .count();
  }

  void makeClients() {
    double groupStartMs = 0.0;
    for (const Phase& phase : script_.phases) {
      if (!phase.withPrevious) groupStartMs = endMs_;
      const double rampMs = phase.rampSeconds * 1000.0;
      const double startMs = groupStartMs + phase.delaySeconds * 1000.0;
      const double phaseEndMs = startMs + rampMs + phase.holdSeconds * 1000.0;
      // The first of every 1 / decode clients decodes; at least one does unless decode is 0.
      const double share = script_.decode;
      for (std::uint32_t i = 0; i < phase.clients; ++i) {
        LightClient::Plan plan;
        plan.phase = &phase;
        plan.index = i;
        plan.startMs = startMs + rampMs * i / phase.clients;
        plan.endMs = phaseEndMs;
        if (std::ceil(share * i) < std::ceil(share * (i + 1)) || (i == 0 && share > 0.0)) {
          plan.makeDecoder = options_.makeDecoder;
        }
        clients_.push_back(std::make_unique<LightClient>(std::move(plan), digests_, counters_));
        idOf_.push_back(kNoConnection);
        due_.emplace(clients_.back()->nextDueMs(), clients_.size() - 1);
      }
      endMs_ = std::max(endMs_, phaseEndMs);
    }
  }

  void tickDue(double now) {
    while (!due_.empty() && due_.top().first <= now) {
      const std::size_t index = due_.top().second;
      due_.pop();
      // Entries are left behind when a client's next time moves; only the present one counts.
      if (clients_[index]->nextDueMs() > now) continue;
      clients_[index]->tick(now);
      follow(index);
    }
  }

  void resumeDue(double now) {
    while (!paused_.empty() && paused_.top().first <= now) {
      const std::size_t index = paused_.top().second;
      paused_.pop();
      if (idOf_[index] != kNoConnection) connections_->resumeReading(idOf_[index]);
    }
  }

  /// Does what a client asks for after any of its methods was called.
  void follow(std::size_t index) {
    LightClient& client = *clients_[index];
    const LightClient::Wish wish = client.takeWish();
    if (wish == LightClient::Wish::kConnect) {
      const Id id = connections_->connect();
      idOf_[index] = id;
      slots_[id] = index;
    }
    for (std::vector<std::uint8_t>& message : client.takeOutgoing()) {
      if (idOf_[index] != kNoConnection) connections_->send(idOf_[index], std::move(message));
    }
    if (idOf_[index] != kNoConnection) {
      const Id id = idOf_[index];
      if (wish == LightClient::Wish::kAbort || wish == LightClient::Wish::kDisconnect) {
        // What still comes on this line is nobody's business any more.
        idOf_[index] = kNoConnection;
        slots_[id] = kNobody;
        if (wish == LightClient::Wish::kAbort) {
          connections_->abort(id);
        } else {
          connections_->close(id);
        }
      }
    }
    const double next = client.nextDueMs();
    if (std::isfinite(next)) due_.emplace(next, index);
  }

  void opened(Id id) override {
    withClient(id, [&](LightClient& c) { c.opened(nowMs()); });
  }

  void received(Id id, std::span<const std::uint8_t> message) override {
    withClient(id, [&](LightClient& client) {
      const double now = nowMs();
      client.received(message, now);
      if (client.readableAtMs() > now + kShortestPauseMs) {
        connections_->pauseReading(id);
        paused_.emplace(client.readableAtMs(), slots_[id]);
      }
    });
  }

  void closed(Id id, const std::string& reason) override {
    withClient(id, [&](LightClient& client) {
      idOf_[slots_[id]] = kNoConnection;
      client.closed(reason, nowMs());
    });
    slots_.erase(id);
  }

  template <class Action>
  void withClient(Id id, const Action& action) {
    const auto found = slots_.find(id);
    if (found == slots_.end() || found->second == kNobody) return;
    const std::size_t index = found->second;
    action(*clients_[index]);
    follow(index);
  }

  static constexpr std::size_t kNobody = static_cast<std::size_t>(-1);
  static constexpr Id kNoConnection = static_cast<Id>(-1);

  const Script& script_;
  const RunOptions& options_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double endMs_ = 0.0;
  Counters counters_;
  SharedDigests digests_;
  std::vector<std::unique_ptr<LightClient>> clients_;
  std::vector<Id> idOf_;                       // by client
  std::unordered_map<Id, std::size_t> slots_;  // client by connection
  DueQueue due_;
  DueQueue paused_;
  std::unique_ptr<LoadConnections> connections_;
};

}  // namespace

Result<Run> runScript(const Script& script, const RunOptions& options) {
  return Runner(script, options).run();
}

}  // namespace limn::load
