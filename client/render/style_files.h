// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/style.h"

#include "shared/core/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace limn {

/// One channel of a stroke's picture: how much ink each pixel holds, row by row from the top.
struct InkImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> ink;
};

/// A texture set as its folder has it.
struct StyleFiles {
  StrokeStyle style;
  InkImage visible;
  InkImage hidden;
};

/// Reads client/assets/NAME. Errors: kInvalidArgument (no such style, naming those there are),
/// kNotFound, kCorrupt, kLimitExceeded.
[[nodiscard]] Result<StyleFiles> readStyle(
    const std::filesystem::path& assets,
    const std::string& name);

}  // namespace limn
