// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn::protocol {

/// Packs the feature bits of the base mesh's half-edges (1 crease, 2 seam; one entry a half-edge)
/// for Base.features: for each half-edge that has any, in ascending order, LEB128 of
/// 4 · (half-edges skipped since the last one) + bits. No features: no bytes.
[[nodiscard]] std::vector<std::uint8_t> packBaseFeatures(std::span<const std::uint8_t> features);

/// The inverse: halfEdgeCount entries, or none when no bytes were sent.
/// Errors: kCorrupt (cut short, past the last half-edge, an entry without bits).
[[nodiscard]] Result<std::vector<std::uint8_t>> unpackBaseFeatures(
    std::span<const std::uint8_t> bytes,
    std::uint32_t halfEdgeCount);

}  // namespace limn::protocol
