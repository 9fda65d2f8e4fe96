// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>

namespace limn {

/// How many payload bytes may be on their way to a client: sending takes from the window,
/// acknowledgements give back. A slow reader stops the stream here instead of filling the server's
/// memory.
class Window {
 public:
  explicit Window(std::uint64_t limitBytes) : limitBytes_(limitBytes) {}

  /// Whether a message may go out now. One larger than the whole window may when nothing else is on
  /// its way.
  [[nodiscard]] bool allows(std::uint64_t messageBytes) const {
    return inFlightBytes() == 0 || inFlightBytes() + messageBytes <= limitBytes_;
  }

  void sent(std::uint64_t messageBytes) { sentBytes_ += messageBytes; }

  /// totalBytes: since the connection opened; late and repeated reports are fine.
  /// Errors: kProtocol (more than was sent).
  [[nodiscard]] Result<void> acknowledge(std::uint64_t totalBytes);

  [[nodiscard]] std::uint64_t inFlightBytes() const { return sentBytes_ - acknowledgedBytes_; }

  [[nodiscard]] std::uint64_t sentBytes() const { return sentBytes_; }

 private:
  std::uint64_t limitBytes_;
  std::uint64_t sentBytes_ = 0;
  std::uint64_t acknowledgedBytes_ = 0;
};

}  // namespace limn
