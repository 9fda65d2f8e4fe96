// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace limn {

/// Hears what a connection has to tell. Every method is called on the connection's own thread, one
/// at a time, must not block, and must not destroy the connection.
class ConnectionListener {
 public:
  virtual ~ConnectionListener() = default;
  /// Once, before any message: the connection may carry messages now.
  virtual void onOpen() = 0;
  /// One whole message. wireBytes: what it took on the wire after the upgrade, WebSocket headers
  /// included, TLS not.
  virtual void onMessage(std::vector<std::uint8_t> message, std::size_t wireBytes) = 0;
  /// Once, last: the connection failed or was closed by the other side. Not called after close().
  virtual void onClosed(const Error& reason) = 0;
};

/// A two-way pipe of protocol messages, used once: a lost one is replaced, not reopened.
class Connection {
 public:
  /// Destroying closes.
  virtual ~Connection() = default;
  /// Begins to connect; the listener hears how it goes and must outlive the connection or close().
  /// Thread: the owner's, once.
  virtual void start(ConnectionListener& listener) = 0;
  /// Queues one message; never blocks. After the connection is lost it does nothing.
  /// Thread: any.
  virtual void send(std::vector<std::uint8_t> message) = 0;
  /// Stops; when it returns, the listener is not called any more. Thread: the owner's, not the
  /// connection's. Idempotent.
  virtual void close() = 0;
};

/// Makes a fresh, unstarted connection to the same place; called again after each loss, on the
/// session's decode thread.
using ConnectionFactory = std::function<std::unique_ptr<Connection>()>;

}  // namespace limn
