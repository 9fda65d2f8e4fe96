// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/image.h"
#include "client/stroke/view_distance.h"
#include "client/stroke/visibility/depth_image.h"
#include "tests/unit/client/render/pixel_groups.h"

#include "shared/core/camera.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Where a drawing of a mesh has no line although the mesh's depth image says that something ends
/// there: an oracle that knows nothing of how lines are found.
namespace limn::outline {

struct GapOptions {
  int reachPx = 2;            // a line as near as this counts
  int darkness = 96;          // of a pixel that belongs to a line; 255 is black on white
  double leastJump = 0.02;    // in depth, of the model's radius, and also
  double steepness = 2.0;     // times what the surface on either side changes in a pixel
  bool innerOutlines = true;  // also where the mesh ends before itself, not only before the paper
};

/// Outline pixels that touch one another without a line near any of them.
struct Gap {
  glm::ivec2 low{0};
  glm::ivec2 high{0};
  int pixels = 0;
  bool isOuter = false;  // before the paper, at least in part

  [[nodiscard]] int extent() const { return std::max(high.x - low.x, high.y - low.y) + 1; }
};

struct Gaps {
  int outlinePixels = 0;
  int missed = 0;
  std::vector<Gap> gaps;  // largest first
};

/// 1 at pixels where the mesh ends before what lies behind, 2 where that is nothing.
/// depth: of the picture's size. radius: the model's.
inline std::vector<std::uint8_t> outlinePixels(
    const DepthImage& depth,
    const Camera& camera,
    double radius,
    const GapOptions& options) {
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(depth.width) +
           static_cast<std::size_t>(x);
  };
  std::vector<float> distance(depth.depth.size());
  for (std::size_t i = 0; i < distance.size(); ++i)
    distance[i] = depth.depth[i] < 1.0F ? viewDistance(camera, depth.depth[i]) : 0.0F;  // 0: paper
  std::vector<std::uint8_t> marks(distance.size(), 0);
  const std::array<glm::ivec2, 4> steps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (int y = 2; y + 2 < depth.height; ++y) {
    for (int x = 2; x + 2 < depth.width; ++x) {
      const float here = distance[at(x, y)];
      if (here == 0.0F) continue;
      std::uint8_t& mark = marks[at(x, y)];
      for (const glm::ivec2& step : steps) {
        const float there = distance[at(x + step.x, y + step.y)];
        if (there == 0.0F) {
          mark = 2;
          continue;
        }
        if (!options.innerOutlines || mark == 2) continue;
        const auto slope = [](float a, float b) {
          return a == 0.0F || b == 0.0F ? 0.0F : std::abs(a - b);
        };
        const float before = slope(here, distance[at(x - step.x, y - step.y)]);
        const float beyond = slope(there, distance[at(x + 2 * step.x, y + 2 * step.y)]);
        const double jump = there - here;
        if (jump > options.leastJump * radius + options.steepness * std::max(before, beyond))
          mark = 1;
      }
    }
  }
  return marks;
}

/// picture: dark lines on white paper, of the depth image's size.
inline Gaps findGaps(
    const Image& picture,
    const DepthImage& depth,
    const Camera& camera,
    double radius,
    const GapOptions& options = {}) {
  Gaps result;
  const int width = depth.width;
  const int height = depth.height;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  const std::vector<std::uint8_t> marks = outlinePixels(depth, camera, radius, options);
  const auto hasLine = [&](int x, int y) {
    for (int v = std::max(0, y - options.reachPx); v <= std::min(height - 1, y + options.reachPx);
         ++v) {
      for (int u = std::max(0, x - options.reachPx); u <= std::min(width - 1, x + options.reachPx);
           ++u) {
        if (255 - picture.rgba[4 * at(u, v) + 1] >= options.darkness) return true;
      }
    }
    return false;
  };
  PixelMarks missed{width, height, std::vector<std::uint8_t>(marks.size(), 0)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (marks[at(x, y)] == 0) continue;
      ++result.outlinePixels;
      if (hasLine(x, y)) continue;
      ++result.missed;
      missed.marks[at(x, y)] = marks[at(x, y)];
    }
  }
  for (const std::vector<glm::ivec2>& group : pixelGroups(missed, 2)) {
    Gap gap{group.front(), group.front(), static_cast<int>(group.size()), false};
    for (const glm::ivec2& p : group) {
      gap.low = glm::min(gap.low, p);
      gap.high = glm::max(gap.high, p);
      gap.isOuter = gap.isOuter || missed.at(p) == 2;
    }
    result.gaps.push_back(gap);
  }
  std::stable_sort(result.gaps.begin(), result.gaps.end(), [](const Gap& a, const Gap& b) {
    return a.extent() > b.extent();
  });
  return result;
}

}  // namespace limn::outline
