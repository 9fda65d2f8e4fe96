// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// What a vector line can keep of a stroke's picture.
struct StrokeShape {
  float thickness = 1.0F;  // share of the picture's height that is inked, where it is
  float strength = 1.0F;   // mean ink of what is inked
  /// Lengths of ink and gap in turn, as shares of the repeat; empty when inked throughout. Dashes
  /// of much the same length are one dash.
  std::vector<float> dashes;
  float dashStart = 0.0F;  // where the first of them begins, share of the repeat
};

/// ink: rows of `width` bytes; one repeat from left to right. Specks and pinholes shorter than a
/// fiftieth of the repeat do not count. Cost: O(pixels).
[[nodiscard]] StrokeShape strokeShape(std::span<const std::uint8_t> ink, int width);

}  // namespace limn
