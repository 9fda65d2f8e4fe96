// SPDX-License-Identifier: Apache-2.0
#include "client/net/asset_connection.h"

#include "client/net/local_connection.h"

#include "protocol/limits.h"
#include "protocol/messages.h"

#include <utility>

namespace limn {
namespace {

/// What may be on its way unacknowledged; above the largest message, so that each fits alone.
constexpr std::uint64_t kWindowBytes = 8 * 1024 * 1024;

class AssetConnection final : public LocalConnection {
 public:
  explicit AssetConnection(std::shared_ptr<const AssetFiles> files) : files_(std::move(files)) {}

  ~AssetConnection() override { close(); }

 protected:
  void play() override {
    while (auto bytes = receive())
      answer(*bytes);
  }

 private:
  void answer(const std::vector<std::uint8_t>& bytes) {
    const auto message = protocol::decodeMessage(bytes, protocol::Sender::kClient);
    if (!message) return lose(message.error());
    if (message->as<protocol::Hello>() != nullptr) {
      tell(encodeMessage(protocol::Welcome{limits::kProtocolVersion, "asset"}));
    } else if (const auto* open = message->as<protocol::Open>()) {
      if (open->resume) {
        // Files do not get lost on the way: who wants to resume got damaged data, and starts anew.
        tell(encodeMessage(protocol::Failure{
            protocol::WireError::kStale,
            open->channel,
            "read the asset again",
            0}));
        return;
      }
      tell(files_->info);
      next_ = 0;
    } else if (const auto* acknowledge = message->as<protocol::Acknowledge>()) {
      acknowledged_ = acknowledge->bytes;
    }
    fillWindow();
  }

  void fillWindow() {
    while (next_ < files_->payload.size() && !isClosed()) {
      const auto& message = files_->payload[next_];
      if (told_ + message.size() > acknowledged_ + kWindowBytes) return;
      told_ += message.size();
      ++next_;
      tell(message);
    }
  }

  const std::shared_ptr<const AssetFiles> files_;
  std::size_t next_ = SIZE_MAX;  // of the payload; not begun
  std::uint64_t told_ = 0;
  std::uint64_t acknowledged_ = 0;
};

}  // namespace

std::unique_ptr<Connection> makeAssetConnection(std::shared_ptr<const AssetFiles> files) {
  return std::make_unique<AssetConnection>(std::move(files));
}

}  // namespace limn
