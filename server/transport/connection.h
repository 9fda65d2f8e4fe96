// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/peer.h"
#include "server/session/rate_limit.h"
#include "server/session/session.h"
#include "server/transport/limits.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

struct lws;

namespace limn {

/// What all connections of a server have taken and given.
struct TrafficCounters {
  std::uint64_t sentBytes = 0;
  std::uint64_t sentMessages = 0;
  std::uint64_t receivedMessages = 0;
};

/// One WebSocket: puts messages together, keeps the client to its limits, writes what its session
/// has to say. Where a method returns an int, it is what a libwebsockets callback is to return: −1
/// closes. Loop thread only.
class Connection final : public Peer {
 public:
  struct Shared {
    const TransportLimits& limits;
    SessionShared& sessions;
    TrafficCounters& traffic;
    std::vector<std::uint8_t>& scratch;  // for writing
  };

  struct Client {
    lws* socket = nullptr;
    std::uint64_t number = 0;
    std::shared_ptr<const Grant> grant;  // nullptr: everything
  };

  Connection(Client client, Shared shared, std::int64_t nowMs);

  void wantWrite() override;

  [[nodiscard]] int receive(const void* in, std::size_t size, std::int64_t nowMs);
  [[nodiscard]] int write(std::int64_t nowMs);

  /// The client answered a ping.
  void answered(std::int64_t nowMs) { heardMs_ = nowMs; }

  /// The payload of the client's close frame. 0: the library answers it as it is.
  [[nodiscard]] int closedByPeer(std::string_view payload);
  /// At least about once a second: deadlines. False when the socket is to be cut.
  [[nodiscard]] bool tick(std::int64_t nowMs);

  /// See Session::update().
  void update(std::int64_t nowMs) {
    noteQuiet(nowMs);
    session_.update(nowMs);
  }

  /// See Session.
  [[nodiscard]] std::optional<std::int64_t> dueMs() const { return session_.dueMs(); }

  void drain(std::uint32_t retryAfterMs);

  [[nodiscard]] std::uint64_t number() const { return number_; }

  [[nodiscard]] std::int64_t bornMs() const { return session_.bornMs(); }

  [[nodiscard]] Ending ending() const { return ending_; }

  [[nodiscard]] const std::string& endingReason() const { return session_.closeReason(); }

  [[nodiscard]] std::uint64_t payloadBytes() const { return session_.payloadBytes(); }

  /// Memory held for this client, what is shared excluded.
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(*this) - sizeof(session_) + session_.bytes() + partial_.capacity() +
           (next_ ? sizeof(OutMessage) + next_->owned.capacity() : 0);
  }

 private:
  void askToWrite();
  [[nodiscard]] int ping();
  [[nodiscard]] int say(std::int64_t nowMs);
  [[nodiscard]] int put(protocol::Bytes bytes, std::int64_t nowMs);
  [[nodiscard]] int farewell();
  int closeNow(int code, const std::string& reason, Ending ending);
  void giveUp(const std::string& why, Ending ending, std::int64_t nowMs);
  void noteQuiet(std::int64_t nowMs);
  [[nodiscard]] bool stalled(std::int64_t nowMs);

  lws* wsi_;
  std::uint64_t number_;
  Shared shared_;
  Session session_;
  RateLimit rate_;
  std::vector<std::uint8_t> partial_;  // of a message that came in pieces
  Ending ending_ = Ending::kLeft;
  std::unique_ptr<OutMessage> next_;  // made before the network could take it
  bool wantsWrite_ = false;           // the socket was asked for a callback
  bool receiving_ = false;            // what the session wants then is asked for afterwards
  bool pingWanted_ = false;
  std::int64_t pingedMs_ = 0;    // since it was last heard; 0: not
  std::int64_t heardMs_;         // when anything last came
  std::int64_t givenUpMs_ = 0;   // 0: not
  std::int64_t progressMs_ = 0;  // when something was last written or taken by the network
  std::int64_t lookedMs_ = 0;    // when the network's queue was last looked at
  int queuedBytes_ = 0;          // what was in it then
};

}  // namespace limn
