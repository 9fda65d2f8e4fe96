// SPDX-License-Identifier: Apache-2.0
// Based on: A. Appel, F. J. Rohlf, A. J. Stein, "The Haloed Line Effect for Hidden Line
// Elimination", SIGGRAPH 1979: a line that passes behind another is interrupted beside it.
// Deviation: so are lines that run along it, for as long as they do.
#include "client/stroke/line_halo.h"

#include <algorithm>
#include <cmath>

namespace limn {

float haloCellPx(float widthPx) {
  return std::max(1.0F, kHaloWidths * widthPx / kHaloCells);
}

int haloCells(int pixels, float cellPx) {
  return std::max(1, static_cast<int>(std::ceil(static_cast<float>(pixels) / cellPx)));
}

LineHalo::LineHalo(const Viewport& viewport, float widthPx)
    : cellPx_(haloCellPx(widthPx)),
      size_(haloCells(viewport.width, cellPx_), haloCells(viewport.height, cellPx_)),
      cells_(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y), 0) {}

void LineHalo::add(const glm::vec2& pixel) {
  const glm::ivec2 cell(glm::floor(pixel / cellPx_));
  if (cell.x < 0 || cell.y < 0 || cell.x >= size_.x || cell.y >= size_.y) return;
  cells_[static_cast<std::size_t>(cell.y * size_.x + cell.x)] = 1;
}

bool LineHalo::isMarked(const glm::ivec2& cell) const {
  if (cell.x < 0 || cell.y < 0 || cell.x >= size_.x || cell.y >= size_.y) return false;
  return cells_[static_cast<std::size_t>(cell.y * size_.x + cell.x)] != 0;
}

bool LineHalo::isNear(const glm::vec2& pixel) const {
  const glm::ivec2 cell(glm::floor(pixel / cellPx_));
  for (int dy = -kHaloCells; dy <= kHaloCells; ++dy) {
    for (int dx = -kHaloCells; dx <= kHaloCells; ++dx) {
      if (isInHalo(dx, dy) && isMarked(cell + glm::ivec2(dx, dy))) return true;
    }
  }
  return false;
}

}  // namespace limn
