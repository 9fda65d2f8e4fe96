// SPDX-License-Identifier: Apache-2.0
#include "client/load/mesh_decoder.h"

#include "client/core/have_set.h"
#include "client/core/stream_decoder.h"

namespace limn::load {
namespace {

class MeshDecoder : public PayloadDecoder {
 public:
  Result<std::uint64_t> decode(const protocol::Message& message) override {
    const std::uint64_t before = splitsHeld();
    Result<void> taken;
    if (const auto* info = message.as<protocol::ModelInfo>()) {
      taken = decoder_.beginModel(*info);
    } else if (const auto* base = message.as<protocol::Base>()) {
      taken = decoder_.take(*base);
    } else if (const auto* block = message.as<protocol::LevelBlock>()) {
      taken = decoder_.take(*block);
    } else if (const auto* packet = message.as<protocol::Packet>()) {
      taken = decoder_.take(*packet);
    } else if (const auto* seeds = message.as<protocol::Seeds>()) {
      taken = decoder_.take(*seeds);
    }
    if (!taken) return tl::unexpected(taken.error());
    return splitsHeld() - before;
  }

  std::vector<std::vector<std::uint8_t>> haveSet(std::uint8_t channel) const override {
    return encodeHaveSet(decoder_, channel);
  }

 private:
  [[nodiscard]] std::uint64_t splitsHeld() const {
    return decoder_.hasBase() ? decoder_.mesh().splitsHeld() : 0;
  }

  StreamDecoder decoder_;
};

}  // namespace

std::unique_ptr<PayloadDecoder> makeMeshDecoder() {
  return std::make_unique<MeshDecoder>();
}

}  // namespace limn::load
