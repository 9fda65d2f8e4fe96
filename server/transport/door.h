// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/grant.h"
#include "server/session/rate_limit.h"
#include "server/transport/http_routes.h"
#include "server/transport/limits.h"

#include "shared/core/result.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

struct lws;

namespace limn {

struct Socket;
struct TransportEvent;
struct TransportOptions;

/// Who is at the other end of a socket, as limits count it.
[[nodiscard]] std::string addressOf(int file);

/// A word to somebody whose request will not be read. Best effort: it may be lost.
void sayAtTheDoor(int file, int status, const std::string& why);

/// Who is let in: counts sockets, clients and those who are turned away. Loop thread only.
class Door {
 public:
  /// What an upgrade comes to.
  enum class Port : std::uint8_t { kMain, kDraining, kMetrics };

  /// options: outlive this; happened: is told of some of the refusals; may be empty.
  Door(const TransportOptions& options, std::function<void(const TransportEvent&)> happened);

  /// A socket that comes in. 0: it may; otherwise it is to be closed.
  [[nodiscard]] int filter(int file);

  void enter(const std::string& address) { sockets_.enter(address); }

  void leave(const std::string& address) { sockets_.leave(address); }

  /// Whether a request to become something else is one to become a WebSocket.
  [[nodiscard]] static bool asksForWebSocket(lws* wsi);

  /// Of such a request: why not, or nullopt, and then `socket` has its grant.
  [[nodiscard]] std::optional<HttpReply> refuse(lws* wsi, Socket& socket, Port port);

  void enterClient(const std::string& address) { clients_.enter(address); }

  void leaveClient(const std::string& address) { clients_.leave(address); }

  /// What the request's token allows. Errors: as AccessRules::admit().
  [[nodiscard]] Result<std::shared_ptr<const Grant>> grantOf(lws* wsi) const;

  /// Counts a refusal; its answer.
  [[nodiscard]] HttpReply
  turnAway(Refusal why, const std::string& address, const std::string& text);

  [[nodiscard]] const std::array<std::uint64_t, 6>& refused() const { return refused_; }

 private:
  void countRefusal(Refusal why, const std::string& address);

  const TransportOptions& options_;
  std::function<void(const TransportEvent&)> happened_;
  ConnectionCounter sockets_;
  ConnectionCounter clients_;
  std::array<std::uint64_t, 6> refused_{};  // by Refusal
  RateLimit refusalLog_;
};

}  // namespace limn
