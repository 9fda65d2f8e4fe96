// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Points of a picture in square cells, for the distance to the nearest. Copies them.
class PixelPoints {
 public:
  /// limitPx: distances beyond it count as it.
  PixelPoints(std::span<const glm::vec2> points, int width, int height, double limitPx);

  /// Distance to the nearest point, at most limitPx. Cost: O(points within it).
  [[nodiscard]] float distanceTo(const glm::vec2& p) const;

 private:
  [[nodiscard]] glm::ivec2 cellOf(const glm::vec2& p) const;

  int columns_;
  int rows_;
  float limit_;
  std::vector<std::uint32_t> begin_;  // by cell, and the end
  std::vector<glm::vec2> sorted_;     // by cell
};

}  // namespace limn
