// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/transport/socket_list.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_set>

namespace limn {

/// All sockets that are there: whose session has something to do, and whose time is up. Costs what
/// has something to do costs, not what there is (README.md, "Crowds"). Loop thread only.
class Crowd {
 public:
  /// A socket that has said nothing yet: it has until its deadline.
  void add(Socket& socket) { young_.insert(&socket); }

  /// It has a connection now, and no deadline.
  void connect(Socket& socket);
  /// It has none any more, or is gone.
  void remove(Socket& socket);

  [[nodiscard]] std::size_t size() const { return connected_.size(); }

  [[nodiscard]] bool isEmpty() const { return connected_.empty(); }

  /// Memory of all connections.
  [[nodiscard]] std::size_t bytes() const;

  /// After anything was done with a connection: when it is to be updated.
  void noteDue(Socket& socket);
  /// Updates those that are due.
  void update(std::int64_t nowMs);

  /// Closes whose time is up: of those with a connection so many are looked at that each has its
  /// turn once a second. sinceMs: since the last call. isLate: told of those without. True when one
  /// was closed: the library must be woken then.
  bool cutLate(
      std::int64_t nowMs,
      std::int64_t sinceMs,
      const std::function<void(const Socket& late)>& isLate);

  /// Tells all to go elsewhere, and to come back spread over a while.
  void drain();

 private:
  std::unordered_set<Socket*> young_;  // with a deadline
  SocketList<&Socket::place> connected_;
  SocketList<&Socket::livelyPlace> lively_;  // to be updated
  std::size_t looked_ = 0;                   // whose deadlines come next, of connected_
};

}  // namespace limn
