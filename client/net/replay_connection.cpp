// SPDX-License-Identifier: Apache-2.0
#include "client/net/replay_connection.h"

#include "client/net/local_connection.h"

#include "protocol/messages.h"

#include <utility>

namespace limn {
namespace {

class ReplayConnection final : public LocalConnection {
 public:
  explicit ReplayConnection(std::vector<ReplayStep> steps) : steps_(std::move(steps)) {}

  ~ReplayConnection() override { close(); }

 protected:
  void play() override {
    for (ReplayStep& step : steps_) {
      while (!step.awaits.empty()) {
        const auto bytes = receive();
        if (!bytes) return;
        const auto message = protocol::decodeMessage(*bytes, protocol::Sender::kClient);
        if (message && nameOf(message->body) == step.awaits) break;
      }
      if (!step.message.empty()) tell(std::move(step.message));
      if (step.lost) return lose({ErrorCode::kNetwork, "the recording ends in a loss"});
    }
    while (receive()) {
    }
  }

 private:
  std::vector<ReplayStep> steps_;
};

}  // namespace

std::unique_ptr<Connection> makeReplayConnection(std::vector<ReplayStep> steps) {
  return std::make_unique<ReplayConnection>(std::move(steps));
}

}  // namespace limn
