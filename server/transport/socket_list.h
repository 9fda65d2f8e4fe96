// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/grant.h"
#include "server/transport/connection.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

struct lws;

namespace limn {

/// What stays with a socket from being accepted to being closed. Loop thread only.
struct Socket {
  lws* wsi = nullptr;
  std::string address;
  std::int64_t deadlineMs = 0;  // for its request, or its answer; 0: none, it is a WebSocket
  bool answered = false;
  std::shared_ptr<const Grant> grant;  // of an upgrade that is let in
  std::unique_ptr<Connection> connection;
  std::size_t place = kNowhere;        // among those with a connection
  std::size_t livelyPlace = kNowhere;  // among the lively ones
  std::int64_t dueMs = 0;              // of those: when to update it

  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

  /// Of its token, if it says.
  [[nodiscard]] std::string subject() const { return grant ? grant->subject : std::string(); }
};

/// Some sockets; each knows its place, so that coming and going cost the same for any number. Loop
/// thread only.
template <std::size_t Socket::*Place>
class SocketList {
 public:
  [[nodiscard]] std::size_t size() const { return sockets_.size(); }

  [[nodiscard]] bool empty() const { return sockets_.empty(); }

  [[nodiscard]] Socket& operator[](std::size_t i) const { return *sockets_[i]; }

  [[nodiscard]] auto begin() const { return sockets_.begin(); }

  [[nodiscard]] auto end() const { return sockets_.end(); }

  void add(Socket& socket) {
    if (socket.*Place != Socket::kNowhere) return;
    socket.*Place = sockets_.size();
    sockets_.push_back(&socket);
  }

  /// The last one takes its place.
  void remove(Socket& socket) {
    const std::size_t place = std::exchange(socket.*Place, Socket::kNowhere);
    if (place == Socket::kNowhere) return;
    sockets_[place] = sockets_.back();
    if (sockets_[place] != &socket) sockets_[place]->*Place = place;
    sockets_.pop_back();
  }

 private:
  std::vector<Socket*> sockets_;
};

}  // namespace limn
