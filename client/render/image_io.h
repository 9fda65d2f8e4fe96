// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/image.h"

#include "shared/core/result.h"

#include <cstdint>
#include <filesystem>
#include <span>

namespace limn {

/// Writes a PNG beside `path` and renames it into place, so that no half picture is ever seen.
/// Errors: kIo, kInvalidArgument (an empty picture).
[[nodiscard]] Result<void> writePng(const std::filesystem::path& path, const Image& image);

/// Reads any PNG of at most 8192 × 8192 pixels as RGBA. Errors: kNotFound, kCorrupt,
/// kLimitExceeded.
[[nodiscard]] Result<Image> readPng(const std::filesystem::path& path);

/// What a PNG in memory must be.
struct PngShape {
  int width = 0;
  int height = 0;
  int channels = 4;
};

/// A PNG in memory that must have this shape, as RGBA; grey goes to red, green and blue.
/// Errors: kCorrupt.
[[nodiscard]] Result<Image> decodePng(std::span<const std::uint8_t> bytes, const PngShape& shape);

}  // namespace limn
