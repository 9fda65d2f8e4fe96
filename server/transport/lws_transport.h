// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/session.h"
#include "server/transport/access.h"
#include "server/transport/http_routes.h"
#include "server/transport/limits.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace limn {

struct TransportOptions {
  ListenAddress listen;
  std::optional<ListenAddress> metricsListen;
  std::string tlsCertificate;  // PEM files; both or none
  std::string tlsKey;
  AccessRules access;
  TransportLimits limits;
  std::int64_t drainMs = 20'000;  // for clients to take their last messages
};

/// Something that happened at the door.
struct TransportEvent {
  enum class Kind : std::uint8_t { kOpened, kClosed, kRefused };

  Kind kind = Kind::kOpened;
  std::uint64_t connection = 0;  // its number; 0 for one that was refused
  std::string address;
  std::string why;  // how it ended, or why it was refused
  double seconds = 0.0;
  std::uint64_t payloadBytes = 0;
  std::string subject = {};  // of its token, if it says
};

/// What the transport asks its owner for. All on the loop thread.
struct TransportHandlers {
  std::function<ServerStatus()> status;  // the transport fills in what it counts itself
  std::function<const std::vector<CatalogueItem>&()> catalogue;
  std::function<void(std::int64_t nowMs)> tick;         // about 20 times a second
  std::function<void()> woken;                          // after wake()
  std::function<void(const TransportEvent&)> happened;  // may be empty
};

/// WebSocket and HTTP on libwebsockets with a libev loop. One loop thread owns everything.
class LwsTransport {
 public:
  virtual ~LwsTransport() = default;

  /// Opens the ports. Errors: kIo (taken, not ours, bad certificate), with what to do.
  /// shared and handlers must outlive it.
  [[nodiscard]] static Result<std::unique_ptr<LwsTransport>>
  open(const TransportOptions& options, SessionShared& shared, const TransportHandlers& handlers);

  /// The port that is listened on; the real one when 0 was asked for.
  [[nodiscard]] virtual int port() const = 0;
  [[nodiscard]] virtual int metricsPort() const = 0;  // 0: none

  /// Runs the loop until SIGTERM or SIGINT has been received and the clients are gone.
  virtual void run() = 0;

  /// From any thread: makes the loop call `woken`, then update() of every session.
  virtual void wake() = 0;

  /// Milliseconds of the loop's monotonic clock.
  [[nodiscard]] static std::int64_t nowMs();
};

}  // namespace limn
