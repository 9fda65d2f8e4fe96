// SPDX-License-Identifier: Apache-2.0
#include "server/session/model_start.h"

#include <algorithm>

namespace limn {

std::optional<protocol::Bytes>
ModelStart::next(const Model& model, HaveSet& have, std::uint32_t room, const Window& window) {
  if (!baseSent_) {
    if (!window.allows(model.base().size())) return std::nullopt;
    baseSent_ = true;
    have.addRange(0, model.forest().baseVertexCount());
    return model.base();
  }
  const auto& levelBegin = model.forest().levelBegin;
  while (!blocksDone_) {
    if (nextBlock_ >= model.blocks().size()) {
      blocksDone_ = true;
      break;
    }
    const std::uint32_t begin = levelBegin[nextBlock_ + 1];
    const std::uint32_t end = levelBegin[nextBlock_ + 2];
    const std::uint32_t held = have.countRange(begin, end);
    if (held == end - begin) {
      ++nextBlock_;
      continue;
    }
    if (held != 0 || room < end - begin) {
      // Held in part (a resumed client that has dropped some), or too much for it: what is needed
      // comes in packets, and finer blocks could lack prerequisites.
      blocksDone_ = true;
      break;
    }
    const protocol::Bytes block = model.blocks()[nextBlock_];
    if (!window.allows(block.size())) return std::nullopt;
    ++nextBlock_;
    have.addRange(begin, end);
    return block;
  }
  return std::nullopt;
}

std::optional<protocol::Seeds>
ModelStart::nextSeeds(const Model& model, std::size_t mostBytes, const Window& window) {
  const std::size_t size = std::min(mostBytes, model.seeds().size() - seedsSent_);
  if (!window.allows(size)) return std::nullopt;
  protocol::Seeds piece;
  piece.seeds = model.seeds().subspan(seedsSent_, size);
  piece.offset = static_cast<std::uint32_t>(seedsSent_);
  piece.total = static_cast<std::uint32_t>(model.seeds().size());
  seedsSent_ += size;
  return piece;
}

HaveSet ModelStart::after(const Model& model, const HaveSet& have, std::uint32_t room) const {
  const auto& levelBegin = model.forest().levelBegin;
  HaveSet then = have;
  then.addRange(0, levelBegin[1]);
  for (std::size_t block = nextBlock_; !blocksDone_ && block < model.blocks().size(); ++block) {
    const std::uint32_t begin = levelBegin[block + 1];
    const std::uint32_t end = levelBegin[block + 2];
    const std::uint32_t held = then.countRange(begin, end);
    // As next().
    if (held == end - begin) continue;
    if (held != 0 || room < then.count() - have.count() + (end - begin)) break;
    then.addRange(begin, end);
  }
  return then;
}

}  // namespace limn
