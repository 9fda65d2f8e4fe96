// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace limn::protocol {

/// Bytes that a WebSocket frame header takes before an unmasked payload of this length
/// [RFC 6455, 5.2].
[[nodiscard]] constexpr std::size_t webSocketHeaderBytes(std::size_t payloadBytes) {
  return payloadBytes < 126 ? 2 : payloadBytes <= 0xFFFF ? 4 : 10;
}

/// Bytes that a message takes on the wire as a server's WebSocket frame.
[[nodiscard]] constexpr std::size_t webSocketFrameBytes(std::size_t messageBytes) {
  return webSocketHeaderBytes(messageBytes) + messageBytes;
}

/// What the sections of stored assets hold: raised whenever a program could misread what another
/// one wrote. Reports carry it as "asset_format", and it is part of every asset's id.
inline constexpr int kAssetFormat = 9;

/// Appends one message to a section of an asset: its length as u32 little-endian, then its bytes.
void appendFrame(std::vector<std::uint8_t>& section, std::span<const std::uint8_t> message);

/// Walks the messages of such a section. Reads nothing past its end, whatever the lengths claim.
class FrameReader {
 public:
  explicit FrameReader(std::span<const std::uint8_t> section) : rest_(section) {}

  /// The next message, or nullopt at the end. Errors: kCorrupt (cut short; longer than the largest
  /// message); the reader then stays where it is.
  [[nodiscard]] Result<std::optional<std::span<const std::uint8_t>>> next();

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace limn::protocol
