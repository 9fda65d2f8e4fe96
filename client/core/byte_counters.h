// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/messages.h"

#include <cstddef>
#include <cstdint>

namespace limn {

/// Bytes that have come from the server since the upgrade, WebSocket headers and payloads, TLS and
/// HTTP not counted; over all connections of a session. The parts add up to `received`.
struct ByteCounters {
  std::uint64_t received = 0;
  std::uint64_t base = 0;  // Base without its features
  std::uint64_t levelBlocks = 0;
  std::uint64_t packets = 0;
  std::uint64_t features = 0;  // Base.features; feature bits inside splits count as splits
  std::uint64_t seeds = 0;
  std::uint64_t hull = 0;
  std::uint64_t maps = 0;
  std::uint64_t contours = 0;
  std::uint64_t control = 0;  // everything else

  /// Adds one message that took wireBytes on the wire.
  void count(const protocol::Body& body, std::size_t wireBytes);
  /// Adds bytes of frames that carried no message we understand.
  void countControl(std::size_t wireBytes);
  /// Adds what another session received.
  ByteCounters& operator+=(const ByteCounters& more);
};

}  // namespace limn
