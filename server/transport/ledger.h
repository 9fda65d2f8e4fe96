// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/transport/connection.h"
#include "server/transport/http_routes.h"
#include "server/transport/socket_list.h"

#include <array>
#include <cstdint>
#include <functional>
#include <utility>

namespace limn {

struct TransportEvent;

/// What is counted of a server's connections, and told of each. Loop thread only.
class Ledger {
 public:
  /// happened: is told who came and went; may be empty.
  Ledger(std::function<void(const TransportEvent&)> happened, std::int64_t nowMs)
      : happened_(std::move(happened)),
        startedMs_(nowMs) {}

  /// Of a connection that is made now; from 1.
  [[nodiscard]] std::uint64_t nextNumber() { return ++accepted_; }

  void noteOpened(const Socket& socket) const;
  void noteClosed(const Socket& socket, const Connection& connection, std::int64_t nowMs);

  /// How much later than it should the loop had its turn.
  void noteLag(double seconds) { loopLag_.add(seconds); }

  /// For connections to count in.
  [[nodiscard]] TrafficCounters& traffic() { return traffic_; }

  /// Fills in what is counted here.
  void tell(ServerStatus& status, std::int64_t nowMs) const;

 private:
  std::function<void(const TransportEvent&)> happened_;
  std::int64_t startedMs_;
  std::uint64_t accepted_ = 0;
  std::array<std::uint64_t, 7> endings_{};  // by Ending
  TrafficCounters traffic_;
  TimeCounts loopLag_;
};

}  // namespace limn
