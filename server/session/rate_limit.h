// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace limn {

/// So many things a second, and at most `burst` of them at once (a token bucket). Time is passed
/// in.
class RateLimit {
 public:
  RateLimit(double perSecond, double burst)
      : perMs_(perSecond / 1000.0),
        burst_(burst),
        left_(burst) {}

  /// Whether one more may happen now; then it counts.
  [[nodiscard]] bool take(std::int64_t nowMs) {
    if (!allows(nowMs)) return false;
    left_ -= 1.0;
    return true;
  }

  /// Whether one more might happen now.
  [[nodiscard]] bool allows(std::int64_t nowMs) {
    if (nowMs > atMs_) {
      left_ = std::min(burst_, left_ + perMs_ * static_cast<double>(nowMs - atMs_));
      atMs_ = nowMs;
    }
    return left_ >= 1.0;
  }

  /// So many happened, allowed or not: what is over is waited for.
  void spend(double count) { left_ -= count; }

  /// Allows so many more, up to the burst.
  void give(double count) { left_ = std::min(burst_, left_ + count); }

 private:
  double perMs_;
  double burst_;
  double left_;
  std::int64_t atMs_ = 0;
};

}  // namespace limn
