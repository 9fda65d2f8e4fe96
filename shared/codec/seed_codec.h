// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/silhouette/seed_table.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// The bytes of the message Seeds; protocol/SPEC.md, "Seeds", is their specification. The same
/// seeds give the same bytes. Threads: reentrant. Cost: O(seeds).
[[nodiscard]] std::vector<std::uint8_t> encodeSeeds(const SeedTable& seeds);

/// Total over any bytes. vertexCount: of the model, which every index is checked against. Errors:
/// kCorrupt, kLimitExceeded. Threads: reentrant.
[[nodiscard]] Result<SeedTable> decodeSeeds(
    std::span<const std::uint8_t> bytes,
    std::uint32_t vertexCount);

}  // namespace limn
