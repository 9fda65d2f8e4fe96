// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace limn {

/// An 8-bit picture, row by row from the top, 4 bytes a pixel: red, green, blue, alpha (not
/// premultiplied), sRGB.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

}  // namespace limn
