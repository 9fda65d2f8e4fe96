// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/have_set.h"
#include "server/session/model.h"
#include "server/session/window.h"

#include "protocol/messages.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace limn {

/// How far a channel is with what is the same for everyone: base mesh, level blocks, seeds. Loop
/// thread only.
class ModelStart {
 public:
  /// What a client that resumes has of it, level blocks apart.
  struct Held {
    bool base = false;
    std::size_t seedBytes = 0;
  };

  void resume(const Held& held) {
    baseSent_ = held.base;
    seedsSent_ = held.seedBytes;
  }

  /// Whether base and level blocks are through.
  [[nodiscard]] bool isThrough() const { return baseSent_ && blocksDone_; }

  [[nodiscard]] bool seedsAreThrough(const Model& model) const {
    return seedsSent_ >= model.seeds().size();
  }

  /// Base, then level blocks: the next message as the asset has it, which adds to `have`. room: for
  /// how many splits. None: the window is full, or it is through.
  [[nodiscard]] std::optional<protocol::Bytes>
  next(const Model& model, HaveSet& have, std::uint32_t room, const Window& window);

  /// The next piece of the seeds, of at most so many bytes, without its channel. None: the window
  /// is full.
  [[nodiscard]] std::optional<protocol::Seeds>
  nextSeeds(const Model& model, std::size_t mostBytes, const Window& window);

  /// What will be held of `have` once base and level blocks are sent.
  [[nodiscard]] HaveSet after(const Model& model, const HaveSet& have, std::uint32_t room) const;

 private:
  bool baseSent_ = false;
  bool blocksDone_ = false;
  std::uint32_t nextBlock_ = 0;
  std::size_t seedsSent_ = 0;  // bytes
};

}  // namespace limn
