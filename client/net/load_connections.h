// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace limn {

/// Many WebSocket connections to one server in one thread, for load tests. libwebsockets on a
/// loop of libev's; no reconnecting, no queues but what send() was given. All methods and callbacks
/// belong to the thread that calls service().
class LoadConnections {
 public:
  using Id = std::size_t;

  /// Hears what happens, from within service(). May call everything but service().
  class Listener {
   public:
    virtual ~Listener() = default;
    virtual void opened(Id id) = 0;
    /// One whole message; the bytes are gone after the call.
    virtual void received(Id id, std::span<const std::uint8_t> message) = 0;
    /// The connection is gone or could not be had. Its id is not used again.
    virtual void closed(Id id, const std::string& reason) = 0;
  };

  struct Options {
    std::string url;     // ws:// or wss://HOST[:PORT][/PATH]
    std::string token;   // Authorization: Bearer; empty: none
    std::string caFile;  // PEM certificates to trust for wss besides the system's; empty: none
    std::string origin;  // Origin header; empty: none
    std::size_t maxConnections = 1000;
    std::size_t maxMessageBytes = 0;  // longer messages close the connection
    std::string subprotocol;
  };

  /// Errors: kInvalidArgument for the URL, kUnavailable when the process may not open so many
  /// files.
  [[nodiscard]] static Result<std::unique_ptr<LoadConnections>> create(
      Options options,
      Listener& listener);
  ~LoadConnections();
  LoadConnections(const LoadConnections&) = delete;
  LoadConnections& operator=(const LoadConnections&) = delete;

  /// Begins to connect. opened() or closed() follows, from service().
  [[nodiscard]] Id connect();
  /// Queues one binary message. Ignored once the connection is closed or closing.
  void send(Id id, std::vector<std::uint8_t> message);
  /// Closes after what is queued was sent. closed() follows.
  void close(Id id);
  /// Cuts the line without a closing handshake. closed() follows.
  void abort(Id id);
  /// Stops or resumes reading: TCP then pushes back on the server.
  void pauseReading(Id id);
  void resumeReading(Id id);

  /// Serves events for at most `timeoutMs`, less when one came.
  void service(double timeoutMs);

 private:
  struct Impl;
  explicit LoadConnections(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limn
