// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/connection.h"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace limn {

/// A connection whose other end is code in this process, on a thread of its own: what an asset
/// directory and a recording have in common.
class LocalConnection : public Connection {
 public:
  void start(ConnectionListener& listener) final;
  void send(std::vector<std::uint8_t> message) final;
  void close() final;

 protected:
  /// Plays the other end until it returns. Thread: the connection's own. When it returns without
  /// having been closed, nothing more happens until close().
  virtual void play() = 0;

  /// For play(): the client's next message; waits for it. nullopt: closed.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> receive();
  /// For play(): says one message to the client, accounted as one WebSocket frame.
  void tell(std::vector<std::uint8_t> message);
  /// For play(): the connection is lost.
  void lose(const Error& reason);
  [[nodiscard]] bool isClosed();

 private:
  ConnectionListener* listener_ = nullptr;
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::vector<std::uint8_t>> fromClient_;  // guarded by mutex_
  bool closed_ = false;                               // guarded by mutex_
};

}  // namespace limn
