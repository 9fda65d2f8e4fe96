// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/silhouette/seed_table.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

[[nodiscard]] std::vector<std::uint8_t> encodeSeeds(const SeedTable& seeds);
/// Errors: kCorrupt, kLimitExceeded; every index is checked against vertexCount.
[[nodiscard]] Result<SeedTable> decodeSeeds(
    std::span<const std::uint8_t> bytes,
    std::uint32_t vertexCount);

}  // namespace limn
