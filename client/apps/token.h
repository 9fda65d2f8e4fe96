// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <filesystem>
#include <string>

namespace limn {

/// The token to show a server: what the file holds; without a file, what the environment variable
/// LIMN_TOKEN does; empty without either. (Never a flag: command lines can be read by everyone on a
/// machine.) Errors: kNotFound, kInvalidArgument, naming where it came from.
[[nodiscard]] Result<std::string> readToken(const std::filesystem::path& file);

}  // namespace limn
