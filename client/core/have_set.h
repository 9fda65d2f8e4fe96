// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/stream_decoder.h"

#include "protocol/limits.h"

#include <cstdint>
#include <vector>

namespace limn {

/// The HaveSet messages, encoded and in order, that tell a server what `decoder` holds of its model
/// (which it must have begun). At least one; the last one says so. Each has at most pieceBytes of
/// bits. Cost: O(vertices).
[[nodiscard]] std::vector<std::vector<std::uint8_t>> encodeHaveSet(
    const StreamDecoder& decoder,
    std::uint8_t channel,
    std::size_t pieceBytes = limits::kMaxHaveSetPieceBytes);

}  // namespace limn
