// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"
#include "shared/core/result.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// A sorted set of vertex ids as LEB128 gaps (first id, then differences − 1).
[[nodiscard]] std::vector<std::uint8_t> encodeIdSet(std::span<const VertexId> sortedIds);
/// Errors: kCorrupt (not ascending, ≥ vertexCount, cut short).
[[nodiscard]] Result<std::vector<VertexId>> decodeIdSet(
    std::span<const std::uint8_t> bytes,
    std::uint32_t vertexCount);

}  // namespace limn
