// SPDX-License-Identifier: Apache-2.0
// Based on: S. Grabli, F. Durand, F. Sillion, "Density Measure for Line-Drawing Simplification",
// Pacific Graphics 2004: what is drawn depends on how densely the lines around it lie.
// Deviation: lines are thinned and paled, not left out, so that none appears or vanishes when the
// view moves.
#include "client/stroke/line_density.h"

#include <algorithm>
#include <cmath>

namespace limn {

LineDensity::LineDensity(const Viewport& viewport)
    : pixels_(viewport.width, viewport.height),
      size_(densityCells(viewport.width), densityCells(viewport.height)),
      cells_(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y)) {}

void LineDensity::add(const glm::vec2& pixel, bool visible, float lengthPx) {
  const bool isInside =
      pixel.x >= 0.0F && pixel.y >= 0.0F && pixel.x < pixels_.x && pixel.y < pixels_.y;
  if (!isInside) return;
  const glm::ivec2 cell(pixel / static_cast<float>(kDensityCellPx));
  glm::vec2& sum = cells_[static_cast<std::size_t>(cell.y * size_.x + cell.x)];
  (visible ? sum.x : sum.y) += lengthPx;
}

glm::vec2 LineDensity::at(const glm::vec2& pixel) const {
  const glm::vec2 place = pixel / static_cast<float>(kDensityCellPx) - 0.5F;
  const glm::ivec2 low(glm::floor(place));
  const glm::vec2 f = place - glm::floor(place);
  glm::vec2 sum(0.0F);
  for (int y = -1; y <= 2; ++y) {
    for (int x = -1; x <= 2; ++x) {
      const glm::vec2 away = glm::abs(glm::vec2(x, y) - f);
      const glm::vec2 w = glm::max(glm::vec2(0.0F), 1.0F - away / 2.0F) / 2.0F;
      sum += w.x * w.y * countAt(glm::clamp(low + glm::ivec2(x, y), glm::ivec2(0), size_ - 1));
    }
  }
  return sum / static_cast<float>(kDensityCellPx * kDensityCellPx);
}

Crowding crowdingOfVisible(float density, float widthPx) {
  // The line itself is not one that it lies close to.
  const float others = std::max(density - 0.5F / kDensityCellPx, 1e-6F);
  const float share = kLargestShare / (others * std::max(widthPx, 1e-3F));
  return {
      std::clamp(share, kLeastWidth, 1.0F),
      std::clamp(share / kLeastWidth, kLeastOpacity, 1.0F)};
}

Crowding faded(Crowding crowding, float fade) {
  const float width = crowding.width * fade;
  return {std::max(width, kLeastWidth), crowding.opacity * std::min(width / kLeastWidth, 1.0F)};
}

Crowding crowdingOfHidden(float density, float widthPx) {
  const float few = kPaleFrom / std::max(density * widthPx, 1e-6F);
  return {1.0F, std::clamp(few * std::sqrt(few), kPalest, 1.0F)};
}

}  // namespace limn
