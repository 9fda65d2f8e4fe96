// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/mesh/half_edge.h"
#include "shared/silhouette/picture.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace limn {

/// Which sides of faces hide what is behind them.
enum class Occluders : std::uint8_t {
  kFrontFaces,  // enough for a closed mesh, and half the work
  kBothSides,
};

/// Nearness (PictureView::project) of the nearest surface at each pixel centre, row by row from the
/// top; −∞ where there is none.
struct NearnessImage {
  int width = 0;
  int height = 0;
  std::vector<float> nearness;

  [[nodiscard]] float at(int x, int y) const {
    return nearness
        [static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x)];
  }
};

/// Draws a mesh's depth on the CPU: what a client's depth texture holds, for those that have no GL.
/// Faces that reach behind a perspective eye are left out.
/// projected: PictureView::project of every vertex of `triangles`. image: its old pixels are
/// reused. Cost: O(triangles + pixels covered), some 20 ns a small triangle. Threads: reentrant.
void drawNearness(
    std::span<const glm::uvec3> triangles,
    std::span<const glm::vec3> projected,
    Occluders occluders,
    NearnessImage& image);

}  // namespace limn
