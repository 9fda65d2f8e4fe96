// SPDX-License-Identifier: Apache-2.0
#include "client/net/local_connection.h"

#include "protocol/framing.h"

#include <utility>

namespace limn {

void LocalConnection::start(ConnectionListener& listener) {
  listener_ = &listener;
  thread_ = std::thread([this] {
    if (!isClosed()) listener_->onOpen();
    play();
  });
}

void LocalConnection::send(std::vector<std::uint8_t> message) {
  const std::lock_guard lock(mutex_);
  fromClient_.push_back(std::move(message));
  wake_.notify_one();
}

void LocalConnection::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    wake_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
}

std::optional<std::vector<std::uint8_t>> LocalConnection::receive() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return closed_ || !fromClient_.empty(); });
  if (closed_) return std::nullopt;
  auto message = std::move(fromClient_.front());
  fromClient_.pop_front();
  return message;
}

void LocalConnection::tell(std::vector<std::uint8_t> message) {
  if (isClosed()) return;
  const std::size_t wireBytes = protocol::webSocketFrameBytes(message.size());
  listener_->onMessage(std::move(message), wireBytes);
}

void LocalConnection::lose(const Error& reason) {
  if (!isClosed()) listener_->onClosed(reason);
}

bool LocalConnection::isClosed() {
  const std::lock_guard lock(mutex_);
  return closed_;
}

}  // namespace limn
