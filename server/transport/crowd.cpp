// SPDX-License-Identifier: Apache-2.0
#include "server/transport/crowd.h"

#include <libwebsockets.h>

#include <algorithm>

namespace limn {
namespace {

constexpr std::int64_t kLookMs = 1000;     // deadlines are looked at so often
constexpr std::size_t kLookedAtOnce = 64;  // at least
constexpr std::uint32_t kDrainRetryMs = 500;
constexpr std::uint32_t kDrainSpreadMs = 2000;

/// Closes a socket soon, from outside its callbacks.
void cut(lws* wsi) {
  lws_set_timeout(wsi, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
}

}  // namespace

void Crowd::connect(Socket& socket) {
  young_.erase(&socket);
  socket.deadlineMs = 0;
  connected_.add(socket);
}

void Crowd::remove(Socket& socket) {
  young_.erase(&socket);
  connected_.remove(socket);
  lively_.remove(socket);
}

std::size_t Crowd::bytes() const {
  std::size_t bytes = 0;
  for (const Socket* socket : connected_)
    bytes += socket->connection->bytes();
  return bytes;
}

void Crowd::noteDue(Socket& socket) {
  const auto due = socket.connection->dueMs();
  socket.dueMs = due.value_or(0);
  if (due) {
    lively_.add(socket);
  } else {
    lively_.remove(socket);
  }
}

void Crowd::update(std::int64_t nowMs) {
  for (std::size_t i = 0; i < lively_.size();) {
    Socket& socket = lively_[i];
    if (socket.dueMs <= nowMs) {
      socket.connection->update(nowMs);
      noteDue(socket);
    }
    // The last one may have taken its place.
    if (socket.livelyPlace == i) ++i;
  }
}

bool Crowd::cutLate(
    std::int64_t nowMs,
    std::int64_t sinceMs,
    const std::function<void(const Socket& late)>& isLate) {
  bool cuts = false;
  const std::size_t some = std::max<std::size_t>(
      kLookedAtOnce,
      connected_.size() * static_cast<std::size_t>(sinceMs) / kLookMs + 1);
  for (std::size_t i = std::min(some, connected_.size()); i > 0; --i) {
    looked_ = looked_ + 1 < connected_.size() ? looked_ + 1 : 0;
    Socket& socket = connected_[looked_];
    if (socket.connection->tick(nowMs)) {
      noteDue(socket);
      continue;
    }
    cut(socket.wsi);
    cuts = true;
  }
  for (Socket* socket : young_) {
    if (socket->deadlineMs == 0 || nowMs < socket->deadlineMs) continue;
    socket->deadlineMs = 0;
    isLate(*socket);
    cut(socket->wsi);
    cuts = true;
  }
  return cuts;
}

void Crowd::drain() {
  // Not all at the same moment.
  std::uint32_t spread = 0;
  for (const Socket* socket : connected_) {
    socket->connection->drain(kDrainRetryMs + spread);
    spread = (spread + 97) % kDrainSpreadMs;
  }
}

}  // namespace limn
