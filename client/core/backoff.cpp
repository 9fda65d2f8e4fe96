// SPDX-License-Identifier: Apache-2.0
#include "client/core/backoff.h"

#include <algorithm>

namespace limn {
namespace {

constexpr std::uint64_t kFirstMs = 100;
constexpr std::uint64_t kLargestMs = 5'000;

}  // namespace

std::optional<std::uint64_t> Backoff::next(std::uint64_t nowMs, std::uint64_t retryAfterMs) {
  if (!lostAtMs_) lostAtMs_ = nowMs;
  const std::uint64_t least = std::min(kFirstMs << std::min(failedTries_, 10U), kLargestMs);
  const std::uint64_t wait =
      std::max(retryAfterMs, least) + jitter_.below(static_cast<std::uint32_t>(least / 2 + 1));
  ++failedTries_;
  if (nowMs + wait > *lostAtMs_ + giveUpAfterMs_) return std::nullopt;
  return nowMs + wait;
}

void Backoff::reset() {
  lostAtMs_.reset();
  failedTries_ = 0;
}

}  // namespace limn
