// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace limn {

/// Window depth in [0, 1] of the nearest surface at each pixel centre, row by row from the top; 1
/// where there is none. May be larger than the picture it belongs to (see Viewport in its users).
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<float> depth;

  [[nodiscard]] float at(int x, int y) const {
    return depth
        [static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x)];
  }
};

}  // namespace limn
