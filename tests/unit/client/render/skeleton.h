// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/unit/client/render/pixel_groups.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>
#include <vector>

/// Ink of a picture, and the middles of its lines, one pixel wide: its skeleton.
namespace limn::flaws {

/// The eight pixels around one, in order, from the right.
constexpr std::array<glm::ivec2, 8> kAround = {
    {{1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

/// How many parts of ink touch a pixel that do not touch one another beside it: 1 where the pixel
/// can go and they stay connected; 0 inside ink.
inline int partsAround(const PixelMarks& ink, glm::ivec2 p) {
  int count = 0;
  for (std::size_t k = 0; k < 8; k += 2) {
    const bool leaves = ink.at(p + kAround[k + 1]) != 0 || ink.at(p + kAround[(k + 2) % 8]) != 0;
    count += ink.at(p + kAround[k]) == 0 && leaves ? 1 : 0;
  }
  return count;
}

inline int neighbours(const PixelMarks& ink, glm::ivec2 p) {
  int count = 0;
  for (const glm::ivec2& step : kAround)
    count += ink.at(p + step) != 0 ? 1 : 0;
  return count;
}

inline std::vector<glm::ivec2> pixelsOf(const PixelMarks& ink) {
  std::vector<glm::ivec2> pixels;
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      if (ink.marks[ink.index({x, y})] != 0) pixels.emplace_back(x, y);
    }
  }
  return pixels;
}

/// Peels ink from its four sides in turn until all that is left are lines one pixel wide, as
/// connected as the ink was [Rosenfeld75: A characterization of parallel thinning algorithms].
inline void thin(PixelMarks& ink) {
  std::vector<glm::ivec2> left = pixelsOf(ink);
  std::vector<glm::ivec2> peeled;
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::size_t side : {2U, 6U, 0U, 4U}) {
      peeled.clear();
      for (const glm::ivec2& p : left) {
        const bool isOuter = ink.at(p + kAround[side]) == 0;
        if (isOuter && partsAround(ink, p) == 1 && neighbours(ink, p) > 1) peeled.push_back(p);
      }
      for (const glm::ivec2& p : peeled)
        ink.marks[ink.index(p)] = 0;
      std::erase_if(left, [&](const glm::ivec2& p) { return ink.at(p) == 0; });
      changed = changed || !peeled.empty();
    }
  }
}

/// Pixels of a skeleton and how far along it they are from the first.
struct Walk {
  std::vector<std::pair<glm::ivec2, double>> pixels;

  [[nodiscard]] bool has(glm::ivec2 p) const {
    return std::any_of(pixels.begin(), pixels.end(), [&](const auto& q) { return q.first == p; });
  }
};

/// Everything that a skeleton connects with a pixel within so many pixels along it.
inline Walk around(const PixelMarks& skeleton, glm::ivec2 from, double mostPx) {
  Walk walk{{{from, 0.0}}};
  for (std::size_t next = 0; next < walk.pixels.size(); ++next) {
    const auto [p, px] = walk.pixels[next];
    for (const glm::ivec2& step : kAround) {
      const double there = px + std::hypot(step.x, step.y);
      if (there > mostPx || skeleton.at(p + step) == 0 || walk.has(p + step)) continue;
      walk.pixels.emplace_back(p + step, there);
    }
  }
  return walk;
}

/// From an end back along its line, as far as a junction if one is nearer.
inline Walk back(const PixelMarks& skeleton, glm::ivec2 end, double mostPx) {
  Walk walk{{{end, 0.0}}};
  for (bool goes = true; goes && walk.pixels.back().second < mostPx;) {
    goes = false;
    const auto [p, px] = walk.pixels.back();
    if (walk.pixels.size() > 1 && neighbours(skeleton, p) > 2) break;
    for (const std::size_t k : {0U, 2U, 4U, 6U, 1U, 3U, 5U, 7U}) {
      const glm::ivec2 q = p + kAround[k];
      if (skeleton.at(q) == 0 || walk.has(q)) continue;
      walk.pixels.emplace_back(q, px + std::hypot(kAround[k].x, kAround[k].y));
      goes = true;
      break;
    }
  }
  return walk;
}

inline std::vector<glm::ivec2> endsOf(const PixelMarks& skeleton) {
  std::vector<glm::ivec2> ends = pixelsOf(skeleton);
  std::erase_if(ends, [&](glm::ivec2 p) { return neighbours(skeleton, p) != 1; });
  return ends;
}

/// Branches that the edges of ink leave are no lines.
inline void dropSpurs(PixelMarks& skeleton, double leastPx) {
  for (const glm::ivec2& end : endsOf(skeleton)) {
    Walk walk = back(skeleton, end, leastPx);
    const auto [last, px] = walk.pixels.back();
    if (px >= leastPx || neighbours(skeleton, last) <= 2) continue;
    walk.pixels.pop_back();
    for (const auto& [p, at] : walk.pixels)
      skeleton.marks[skeleton.index(p)] = 0;
  }
  thin(skeleton);
}

inline int chessboard(glm::ivec2 d) {
  return std::max(std::abs(d.x), std::abs(d.y));
}

/// The direction of the line that a walk's first pixel is on.
inline glm::dvec2 axis(const Walk& walk) {
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const auto& [p, px] : walk.pixels) {
    const glm::dvec2 d = p - walk.pixels.front().first;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  return {std::cos(angle), std::sin(angle)};
}

using Disc = std::vector<glm::ivec2>;

inline Disc discOf(double radius) {
  Disc disc;
  const int reach = static_cast<int>(radius);
  for (int v = -reach; v <= reach; ++v) {
    for (int u = -reach; u <= reach; ++u) {
      if (std::hypot(u, v) <= radius) disc.emplace_back(u, v);
    }
  }
  return disc;
}

inline bool isFull(const PixelMarks& ink, glm::ivec2 p, const Disc& disc) {
  return std::all_of(disc.begin(), disc.end(), [&](glm::ivec2 d) { return ink.at(p + d) != 0; });
}

/// Ink, and paper where a disc does not fit in between.
inline PixelMarks closed(const PixelMarks& ink, const Disc& disc) {
  PixelMarks grown = ink;
  for (const glm::ivec2& p : pixelsOf(ink)) {
    for (const glm::ivec2& d : disc) {
      if (ink.isInside(p + d)) grown.marks[ink.index(p + d)] = 1;
    }
  }
  PixelMarks result = grown;
  for (const glm::ivec2& p : pixelsOf(grown))
    result.marks[ink.index(p)] = isFull(grown, p, disc) ? 1 : 0;
  return result;
}

}  // namespace limn::flaws
