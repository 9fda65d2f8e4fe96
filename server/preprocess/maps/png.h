// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// An image, 8 bits a channel, top row first, as a PNG: 1 to 4 channels (grey, grey and alpha, RGB,
/// RGBA). Empty: out of memory. The bytes depend on the version of zlib.
[[nodiscard]] std::vector<std::uint8_t>
encodePng(int width, int height, int channels, std::span<const std::uint8_t> texels);

}  // namespace limn
