// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace limn {

/// Hidden lines stop short of visible ones by so many widths of a stroke, from middle to middle:
/// beside one they would be clutter.
inline constexpr float kHaloWidths = 1.5F;

/// Cells in which visible lines are marked, in pixels: a halo is kHaloCells of them wide.
inline constexpr int kHaloCells = 2;

[[nodiscard]] float haloCellPx(float widthPx);

/// Cells along a side of the picture.
[[nodiscard]] int haloCells(int pixels, float cellPx);

/// Whether a cell so many columns and rows away is within the halo.
[[nodiscard]] constexpr bool isInHalo(int dx, int dy) {
  return dx * dx + dy * dy <= kHaloCells * kHaloCells + 1;
}

/// Where visible lines run, so that hidden ones leave room for them [Appel79]. The CPU's
/// counterpart of what the stroke shaders do.
class LineHalo {
 public:
  /// widthPx: of an ordinary stroke.
  LineHalo(const Viewport& viewport, float widthPx);

  /// Marks a place on a visible line; outside the picture, nothing. Lines are to be marked every
  /// pixel or so.
  void add(const glm::vec2& pixel);

  /// Whether a marked place is near. Cost: O(1).
  [[nodiscard]] bool isNear(const glm::vec2& pixel) const;

 private:
  [[nodiscard]] bool isMarked(const glm::ivec2& cell) const;

  float cellPx_;
  glm::ivec2 size_;
  std::vector<std::uint8_t> cells_;  // row after row
};

}  // namespace limn
