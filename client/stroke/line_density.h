// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"

#include <glm/glm.hpp>

#include <vector>

namespace limn {

/// Cells in which lines are counted, pixels a side.
inline constexpr int kDensityCellPx = 16;

/// Visible strokes are at most this share of the mean distance between lines wide; but no thinner
/// than this share of their own width: from there on they pale, down to this.
inline constexpr float kLargestShare = 0.4F;
inline constexpr float kLeastWidth = 0.3F;
inline constexpr float kLeastOpacity = 0.4F;

/// Hidden lines pale where they would cover more than this share of the paper: faster than they
/// grow in number, so that much that is hidden is a pale tone behind what is seen, and no grey.
inline constexpr float kPaleFrom = 0.24F;
inline constexpr float kPalest = 0.08F;

/// Cells along a side of the picture.
[[nodiscard]] constexpr int densityCells(int pixels) {
  return (pixels + kDensityCellPx - 1) / kDensityCellPx;
}

/// How densely the lines of a picture lie: pixels of line a square pixel, visible and hidden ones
/// apart. The CPU's counterpart of what the stroke shaders do.
class LineDensity {
 public:
  explicit LineDensity(const Viewport& viewport);

  /// Adds a piece of line around a pixel; outside the picture, nothing.
  void add(const glm::vec2& pixel, bool visible, float lengthPx = 1.0F);

  /// Visible, hidden: pixels of line in a cell.
  [[nodiscard]] glm::vec2 countAt(const glm::ivec2& cell) const {
    return cells_[static_cast<std::size_t>(cell.y * size_.x + cell.x)];
  }

  /// Visible, hidden: a smooth mean over the cells within two cells of a pixel.
  [[nodiscard]] glm::vec2 at(const glm::vec2& pixel) const;

 private:
  glm::vec2 pixels_;  // of the picture
  glm::ivec2 size_;
  std::vector<glm::vec2> cells_;  // row after row, pixels of line
};

/// What a stroke keeps of itself among others.
struct Crowding {
  float width = 1.0F;    // share of its width
  float opacity = 1.0F;  // share of its opacity
};

/// Of a visible stroke that would be widthPx wide, where visible lines lie so dense.
[[nodiscard]] Crowding crowdingOfVisible(float density, float widthPx);

/// What is left of that where the stroke fades, from 1 (not) to 0: pens have no grey, so it thins
/// out as well, and pales only from kLeastWidth down.
[[nodiscard]] Crowding faded(Crowding crowding, float fade);

/// The same as crowdingOfVisible of a hidden one among hidden ones: it keeps its width.
[[nodiscard]] Crowding crowdingOfHidden(float density, float widthPx);

}  // namespace limn
