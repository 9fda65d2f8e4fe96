// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <filesystem>
#include <string_view>

namespace limn {

/// Writes a whole file beside `path` and renames it into place, so that nobody sees half a file.
/// Errors: kIo.
[[nodiscard]] Result<void> writeOutputFile(
    const std::filesystem::path& path,
    std::string_view bytes);

}  // namespace limn
