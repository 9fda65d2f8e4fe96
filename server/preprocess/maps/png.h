// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// An RGB image, 8 bits a channel, top row first, as a PNG. Empty: out of memory.
[[nodiscard]] std::vector<std::uint8_t>
encodePng(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace limn
