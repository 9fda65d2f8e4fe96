// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/render/renderer.h"
#include "client/stroke/chain/polyline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

/// How a picture's outline is compared with another's: by how much of each pixel is covered.
namespace limn::outline {

/// How much of each pixel is covered, row by row, found by drawing on black and on white paper.
/// Empty when drawing fails.
inline Result<std::vector<double>> coverage(
    Renderer& renderer,
    const MeshSnapshot& snapshot,
    const PolylineSet& lines,
    const Camera& camera,
    RenderOptions options) {
  std::vector<double> result;
  for (const float paper : {0.0F, 1.0F}) {
    options.paper = glm::vec3(paper);
    const auto frame = renderer.render(snapshot, lines, camera, options);
    if (!frame) return tl::unexpected(frame.error());
    result.resize(frame->image.rgba.size() / 4);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const double value = frame->image.rgba[4 * i + 1] / 255.0;
      result[i] = paper == 0.0F ? value : 1.0 - (value - result[i]);
    }
  }
  return result;
}

/// The mesh's outline in a square picture of `size` pixels, from `side`² samples a pixel; side: a
/// multiple of 4 so that each draws `supersample` 4.
inline Result<std::vector<double>>
truth(Renderer& renderer, const MeshSnapshot& snapshot, const Camera& camera, int size, int side) {
  const int times = side / 4;
  RenderOptions options;
  options.viewport = {times * size, times * size};
  options.draw = DrawMode::kShaded;
  options.supersample = 4;
  auto fine = coverage(renderer, snapshot, {}, camera, options);
  if (!fine || times == 1) return fine;
  std::vector<double> result(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (std::size_t i = 0; i < fine->size(); ++i) {
    const std::size_t x =
        i % static_cast<std::size_t>(times * size) / static_cast<std::size_t>(times);
    const std::size_t y =
        i / static_cast<std::size_t>(times * size) / static_cast<std::size_t>(times);
    result[y * static_cast<std::size_t>(size) + x] += (*fine)[i] / (times * times);
  }
  return result;
}

struct Difference {
  int leaks = 0;  // covered although the truth has nothing within a pixel
  int holes = 0;  // not covered although all around is, within a pixel
  double squares = 0.0;
  double worst = 0.0;
  int edgePixels = 0;  // partly covered in truth

  /// At full contrast.
  [[nodiscard]] double rmsGrey() const {
    return 255.0 * std::sqrt(squares / std::max(edgePixels, 1));
  }
};

/// Adds what a square picture of `size` pixels differs by.
inline void compare(
    const std::vector<double>& ours,
    const std::vector<double>& truth,
    int size,
    Difference& d) {
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * size + x); };
  for (int y = 1; y + 1 < size; ++y) {
    for (int x = 1; x + 1 < size; ++x) {
      double least = 1.0;
      double most = 0.0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          least = std::min(least, truth[at(x + dx, y + dy)]);
          most = std::max(most, truth[at(x + dx, y + dy)]);
        }
      }
      const double t = truth[at(x, y)];
      const double o = ours[at(x, y)];
      if (most < 0.01 && o > 0.01) ++d.leaks;
      if (least > 0.99 && o < 0.99) ++d.holes;
      if (t > 0.01 && t < 0.99) {
        d.squares += (o - t) * (o - t);
        d.worst = std::max(d.worst, std::abs(o - t));
        ++d.edgePixels;
      }
    }
  }
}

}  // namespace limn::outline
