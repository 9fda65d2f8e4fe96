// SPDX-License-Identifier: Apache-2.0
#include "shared/silhouette/contour_distance.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr float kCellPx = 4.0F;

}  // namespace

PixelPoints::PixelPoints(std::span<const glm::vec2> points, int width, int height, double limitPx)
    : columns_(static_cast<int>(static_cast<float>(width) / kCellPx) + 1),
      rows_(static_cast<int>(static_cast<float>(height) / kCellPx) + 1),
      limit_(static_cast<float>(limitPx)) {
  const auto index = [this](const glm::vec2& p) {
    const glm::ivec2 cell = cellOf(p);
    return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(cell.x);
  };
  begin_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const glm::vec2& p : points)
    ++begin_[index(p) + 1];
  for (std::size_t i = 1; i < begin_.size(); ++i)
    begin_[i] += begin_[i - 1];
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  sorted_.resize(points.size());
  for (const glm::vec2& p : points)
    sorted_[next[index(p)]++] = p;
}

glm::ivec2 PixelPoints::cellOf(const glm::vec2& p) const {
  return {
      std::clamp(static_cast<int>(p.x / kCellPx), 0, columns_ - 1),
      std::clamp(static_cast<int>(p.y / kCellPx), 0, rows_ - 1)};
}

float PixelPoints::distanceTo(const glm::vec2& p) const {
  const glm::ivec2 cell = cellOf(p);
  const int rings = static_cast<int>(std::ceil(limit_ / kCellPx));
  float best = limit_ * limit_;
  for (int ring = 0; ring <= rings; ++ring) {
    // Everything in ring r is at least r − 1 cells away.
    const float least = static_cast<float>(ring - 1) * kCellPx;
    if (ring > 0 && best <= least * least) break;
    for (int y = std::max(cell.y - ring, 0); y <= std::min(cell.y + ring, rows_ - 1); ++y) {
      const bool whole = y == cell.y - ring || y == cell.y + ring;
      const int step = whole || ring == 0 ? 1 : 2 * ring;
      for (int x = cell.x - ring; x <= cell.x + ring; x += step) {
        if (x < 0 || x >= columns_) continue;
        const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                       static_cast<std::size_t>(x);
        for (std::uint32_t k = begin_[i]; k < begin_[i + 1]; ++k) {
          const glm::vec2 d = sorted_[k] - p;
          best = std::min(best, glm::dot(d, d));
        }
      }
    }
  }
  return std::sqrt(best);
}

}  // namespace limn
