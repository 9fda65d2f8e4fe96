// SPDX-License-Identifier: Apache-2.0
#include "client/net/asset_connection.h"

#include "client/net/local_connection.h"

#include "protocol/limits.h"
#include "protocol/messages.h"

#include "shared/codec/hull_codec.h"

#include <algorithm>
#include <deque>
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
    } else if (const auto* request = message->as<protocol::GetHull>()) {
      askForHull(*request);
    } else if (const auto* map = message->as<protocol::GetMap>()) {
      // A client only asks where ModelInfo has a map; without the section there is nothing to say.
      const auto& messages = files_->maps[static_cast<std::size_t>(map->kind)];
      for (std::size_t i = map->held; i < messages.size(); ++i)
        hullMessages_.push_back(&messages[i]);
    } else if (const auto* acknowledge = message->as<protocol::Acknowledge>()) {
      acknowledged_ = acknowledge->bytes;
    }
    fillWindow();
  }

  void askForHull(const protocol::GetHull& request) {
    const auto info = protocol::decodeMessage(files_->info, protocol::Sender::kServer);
    const auto* model = info ? info->as<protocol::ModelInfo>() : nullptr;
    const auto& messages = files_->hulls[static_cast<std::size_t>(request.side)];
    if (model == nullptr || !model->hull || messages.empty()) {
      return tell(encodeMessage(protocol::Failure{
          protocol::WireError::kNotFound,
          request.channel,
          "the asset has no hull",
          0}));
    }
    const std::uint32_t base = request.side == protocol::HullSide::kOuter ? model->hull->outerBase
                                                                          : model->hull->innerBase;
    const std::size_t splits = request.faces > base ? (request.faces - base) / 2 : 0;
    const std::size_t end = std::min<std::size_t>(messages.size(), 1 + hullPiecesFor(splits));
    for (std::size_t i = request.held; i < end; ++i)
      hullMessages_.push_back(&messages[i]);
  }

  void fillWindow() {
    while (!hullMessages_.empty() && !isClosed()) {
      const auto& message = *hullMessages_.front();
      if (told_ + message.size() > acknowledged_ + kWindowBytes) return;
      told_ += message.size();
      hullMessages_.pop_front();
      tell(message);
    }
    while (next_ < files_->payload.size() && !isClosed()) {
      const auto& message = files_->payload[next_];
      if (told_ + message.size() > acknowledged_ + kWindowBytes) return;
      told_ += message.size();
      ++next_;
      tell(message);
    }
  }

  const std::shared_ptr<const AssetFiles> files_;
  std::size_t next_ = SIZE_MAX;                                // of the payload; not begun
  std::deque<const std::vector<std::uint8_t>*> hullMessages_;  // asked for, before the rest
  std::uint64_t told_ = 0;
  std::uint64_t acknowledged_ = 0;
};

}  // namespace

std::unique_ptr<Connection> makeAssetConnection(std::shared_ptr<const AssetFiles> files) {
  return std::make_unique<AssetConnection>(std::move(files));
}

}  // namespace limn
