// SPDX-License-Identifier: Apache-2.0
#include "server/session/window.h"

#include <algorithm>
#include <string>

namespace limn {
namespace {

/// The shortest round trip is looked for anew after this long: routes change.
constexpr std::int64_t kRememberMs = 10'000;
constexpr std::uint64_t kStepBytes = 4096;  // of slow growth, a round trip

}  // namespace

void Window::sent(std::uint64_t messageBytes, std::int64_t nowMs) {
  if (inFlightBytes() == 0) progressMs_ = nowMs;
  sentBytes_ += messageBytes;
  // Marks a sixteenth of the largest window apart are enough, and never too many.
  const std::size_t last = (firstMark_ + markCount_ + marks_.size() - 1) % marks_.size();
  const bool isFar =
      markCount_ == 0 || sentBytes_ - marks_[last].sentBytes >= options_.mostBytes / marks_.size();
  if (!isFar || markCount_ == marks_.size()) return;
  marks_[(firstMark_ + markCount_) % marks_.size()] = {sentBytes_, acknowledgedBytes_, nowMs};
  ++markCount_;
}

Result<void> Window::acknowledge(std::uint64_t totalBytes, std::int64_t nowMs) {
  if (totalBytes > sentBytes_) {
    return fail(
        ErrorCode::kProtocol,
        "acknowledged " + std::to_string(totalBytes) + " bytes of " + std::to_string(sentBytes_) +
            " sent");
  }
  if (totalBytes <= acknowledgedBytes_) return {};
  const bool wasUsed = 2 * inFlightBytes() >= limitBytes_;
  const std::uint64_t arrived = totalBytes - acknowledgedBytes_;
  acknowledgedBytes_ = totalBytes;
  progressMs_ = nowMs;
  while (markCount_ > 0 && marks_[firstMark_].sentBytes <= acknowledgedBytes_) {
    learn(marks_[firstMark_], nowMs);
    firstMark_ = (firstMark_ + 1) % marks_.size();
    --markCount_;
  }
  // Doubles in a round trip until something queues for the first time, from then on grows slowly:
  // its effect shows only a round trip later.
  if (wasUsed && queuedMs_ <= options_.queueMs / 2) {
    const std::uint64_t more = wasCut_ ? kStepBytes * arrived / limitBytes_ : arrived;
    limitBytes_ = std::min(limitBytes_ + more, options_.mostBytes);
  }
  return {};
}

void Window::learn(const Mark& mark, std::int64_t nowMs) {
  const std::int64_t roundMs = std::max<std::int64_t>(nowMs - mark.atMs, 0);
  const std::uint64_t least = std::min(options_.leastBytes, options_.mostBytes);
  const bool isOld = nowMs - leastRoundAtMs_ > kRememberMs;
  if (leastRoundMs_ < 0 || roundMs <= leastRoundMs_ || isOld) {
    leastRoundMs_ = roundMs;
    leastRoundAtMs_ = nowMs;
    // Full for so long that every round trip had a queue in it: empty it, to see the link itself.
    if (isOld) limitBytes_ = least;
  }
  queuedMs_ = roundMs - leastRoundMs_;
  if (queuedMs_ <= options_.queueMs) return;
  wasCut_ = true;
  // What came through while this was on its way is what the link carries.
  const double bytesAMs = static_cast<double>(acknowledgedBytes_ - mark.acknowledgedBytes) /
                          static_cast<double>(roundMs);
  const double fits = bytesAMs * static_cast<double>(leastRoundMs_ + options_.queueMs);
  limitBytes_ = std::clamp(static_cast<std::uint64_t>(fits), least, limitBytes_);
}

}  // namespace limn
