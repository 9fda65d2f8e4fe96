// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/rng.h"

#include <cstdint>
#include <optional>

namespace limn {

/// When a lost server is tried again: 100 ms after the first loss, doubled with every further one
/// up to 5 s, with up to half of it as jitter, so that a restarted server is not stormed. Pure;
/// time is an argument.
class Backoff {
 public:
  /// giveUpAfterMs: of losses without any progress between them. seed: of the jitter.
  Backoff(std::uint64_t giveUpAfterMs, std::uint64_t seed)
      : giveUpAfterMs_(giveUpAfterMs),
        jitter_(seed) {}

  /// A loss. Returns when to try again, not before the retryAfterMs that the server may have asked
  /// for (0: it has not); nullopt: it has been tried for long enough.
  [[nodiscard]] std::optional<std::uint64_t> next(std::uint64_t nowMs, std::uint64_t retryAfterMs);

  /// Progress: the next loss is a first one.
  void reset();

 private:
  std::uint64_t giveUpAfterMs_;
  Rng jitter_;
  std::uint32_t failedTries_ = 0;          // losses in a row
  std::optional<std::uint64_t> lostAtMs_;  // the first of them
};

}  // namespace limn
