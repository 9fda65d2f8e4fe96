// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace limn {

/// The folder of texture sets: `chosen` (`--assets DIR`) if given; else, seen from the running
/// program's own folder, `../share/limn/assets` (installed), else the source tree the program was
/// built from. Errors: kNotFound, naming the places looked at.
[[nodiscard]] Result<std::filesystem::path> findAssets(
    const std::optional<std::filesystem::path>& chosen = std::nullopt);

/// Names of the texture sets in an assets folder, sorted. Empty when there are none.
[[nodiscard]] std::vector<std::string> listStyles(const std::filesystem::path& assets);

}  // namespace limn
