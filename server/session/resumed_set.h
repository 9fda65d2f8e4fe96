// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/have_set.h"
#include "server/session/model.h"
#include "server/session/model_start.h"

#include "protocol/messages.h"

#include "shared/core/result.h"
#include "shared/core/sha256.h"

#include <cstdint>
#include <optional>

namespace limn {

/// What a client that comes back says it holds, in pieces, and whether that can be. Loop thread
/// only.
class ResumedSet {
 public:
  /// resumes: whether pieces will come.
  enum class Resumes : std::uint8_t { kNo, kYes };

  explicit ResumedSet(Resumes resumes) : awaited_(resumes == Resumes::kYes) {}

  /// Whether something is still to come, or to be looked at: nothing can be sent before.
  [[nodiscard]] bool isAwaited() const { return awaited_; }

  /// Whether a piece has come.
  [[nodiscard]] bool hasBegun() const { return asset_.has_value(); }

  /// Whether the last piece has come.
  [[nodiscard]] bool hasEnded() const { return ended_; }

  /// Adds a piece to `have`. Errors: kProtocol (not expected, out of order).
  [[nodiscard]] Result<void> take(const protocol::HaveSet& piece, HaveSet& have);

  /// After the last piece, the model being there: adds the base to `have`. Errors: kCorrupt (of
  /// another asset: stale), kProtocol (not closed under prerequisites, or more than there is).
  [[nodiscard]] Result<ModelStart::Held> finish(const Model& model, HaveSet& have);

 private:
  bool awaited_;
  bool ended_ = false;
  std::optional<Sha256Digest> asset_;
  std::uint32_t next_ = 0;  // where the next piece must begin
  ModelStart::Held start_;
};

}  // namespace limn
