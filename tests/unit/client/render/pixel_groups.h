// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace limn {

/// One byte a pixel, row by row from the top; 0 is nothing, and so is all beyond the borders.
struct PixelMarks {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> marks;

  [[nodiscard]] bool isInside(glm::ivec2 p) const {
    return p.x >= 0 && p.y >= 0 && p.x < width && p.y < height;
  }

  [[nodiscard]] std::size_t index(glm::ivec2 p) const {
    return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(p.x);
  }

  [[nodiscard]] std::uint8_t at(glm::ivec2 p) const { return isInside(p) ? marks[index(p)] : 0; }
};

/// Marked pixels in groups: each has another of its group no more than `reach` rows and columns
/// away. In the order of their first pixels.
inline std::vector<std::vector<glm::ivec2>> pixelGroups(PixelMarks marks, int reach) {
  std::vector<std::vector<glm::ivec2>> groups;
  for (int y = 0; y < marks.height; ++y) {
    for (int x = 0; x < marks.width; ++x) {
      if (marks.at({x, y}) == 0) continue;
      std::vector<glm::ivec2> group = {{x, y}};
      marks.marks[marks.index({x, y})] = 0;
      for (std::size_t next = 0; next < group.size(); ++next) {
        const glm::ivec2 p = group[next];
        for (int v = p.y - reach; v <= p.y + reach; ++v) {
          for (int u = p.x - reach; u <= p.x + reach; ++u) {
            if (marks.at({u, v}) == 0) continue;
            marks.marks[marks.index({u, v})] = 0;
            group.emplace_back(u, v);
          }
        }
      }
      groups.push_back(std::move(group));
    }
  }
  return groups;
}

}  // namespace limn
