// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace limn {

struct WindowOptions {
  std::uint64_t mostBytes = 256 * 1024;
  std::uint64_t firstBytes = 64 * 1024;  // before anything is known about the link
  std::uint64_t leastBytes = 16 * 1024;
  /// How long payload may wait on the way: what a new pose has to wait for, beside the round trip.
  std::int64_t queueMs = 100;
};

/// How many payload bytes may be on their way to a client: sending takes from the window,
/// acknowledgements give back. A slow reader stops the stream here instead of filling the server's
/// memory.
///
/// The window follows the link, so that a new pose takes effect soon on a slow one: it grows while
/// acknowledgements come back about as fast as they ever did, and is cut to what the link carries
/// in a round trip and queueMs when they come later than that. (Delay-based congestion control, as
/// LEDBAT [RFC 6817]; TCP below it keeps the network safe, this keeps its queues short.)
class Window {
 public:
  explicit Window(const WindowOptions& options)
      : options_(options),
        limitBytes_(std::min(options.firstBytes, options.mostBytes)) {}

  /// Whether a message may go out now. One larger than the whole window may when nothing else is on
  /// its way.
  [[nodiscard]] bool allows(std::uint64_t messageBytes) const {
    return inFlightBytes() == 0 || inFlightBytes() + messageBytes <= limitBytes_;
  }

  void sent(std::uint64_t messageBytes, std::int64_t nowMs);

  /// totalBytes: since the connection opened; late and repeated reports are fine.
  /// Errors: kProtocol (more than was sent).
  [[nodiscard]] Result<void> acknowledge(std::uint64_t totalBytes, std::int64_t nowMs);

  [[nodiscard]] std::uint64_t inFlightBytes() const { return sentBytes_ - acknowledgedBytes_; }

  [[nodiscard]] std::uint64_t sentBytes() const { return sentBytes_; }

  /// Since when nothing of what is on its way was acknowledged; nullopt: nothing is on its way.
  [[nodiscard]] std::optional<std::int64_t> waitingSinceMs() const {
    return inFlightBytes() == 0 ? std::nullopt : std::optional(progressMs_);
  }

  [[nodiscard]] std::uint64_t limitBytes() const { return limitBytes_; }

 private:
  /// A moment at which something was sent.
  struct Mark {
    std::uint64_t sentBytes = 0;  // with it
    std::uint64_t acknowledgedBytes = 0;
    std::int64_t atMs = 0;
  };

  void learn(const Mark& mark, std::int64_t nowMs);

  WindowOptions options_;
  std::uint64_t limitBytes_;
  std::uint64_t sentBytes_ = 0;
  std::uint64_t acknowledgedBytes_ = 0;
  std::int64_t progressMs_ = 0;  // of the last acknowledgement, or of what was sent first after all
  std::array<Mark, 16> marks_{};  // of what is on its way, a ring, oldest first
  std::size_t firstMark_ = 0;
  std::size_t markCount_ = 0;
  std::int64_t leastRoundMs_ = -1;  // of the last kRememberMs; −1: none yet
  std::int64_t leastRoundAtMs_ = 0;
  bool wasCut_ = false;
  std::int64_t queuedMs_ = 0;  // by how much the last round trip was longer than that
};

}  // namespace limn
