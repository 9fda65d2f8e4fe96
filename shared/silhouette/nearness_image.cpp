// SPDX-License-Identifier: Apache-2.0
// Based on: J. Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988 (edge
// functions).
#include "shared/silhouette/nearness_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

struct Raster {
  int width;
  int height;
  float* pixels;

  /// Counter-clockwise on paper is clockwise in pixels, whose y runs down: area < 0 is front.
  void triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, float area) const {
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x, b.x, c.x}) - 0.5F)));
    const int x1 =
        std::min(width - 1, static_cast<int>(std::floor(std::max({a.x, b.x, c.x}) - 0.5F)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y, b.y, c.y}) - 0.5F)));
    const int y1 =
        std::min(height - 1, static_cast<int>(std::floor(std::max({a.y, b.y, c.y}) - 0.5F)));
    if (x0 > x1 || y0 > y1) return;
    if (area < 0.0F) {
      std::swap(b, c);
      area = -area;
    }
    const float scale = 1.0F / area;
    const glm::vec2 start(static_cast<float>(x0) + 0.5F, static_cast<float>(y0) + 0.5F);
    // Edge functions, ≥ 0 inside: of the corner opposite, and their steps along x and y.
    const auto edge = [&](const glm::vec3& p, const glm::vec3& q) {
      return (q.x - p.x) * (start.y - p.y) - (q.y - p.y) * (start.x - p.x);
    };
    float rowB = edge(c, a);
    float rowC = edge(a, b);
    float rowA = edge(b, c);
    const float stepAx = b.y - c.y;
    const float stepAy = c.x - b.x;
    const float stepBx = c.y - a.y;
    const float stepBy = a.x - c.x;
    const float stepCx = a.y - b.y;
    const float stepCy = b.x - a.x;
    const float zx = (stepAx * a.z + stepBx * b.z + stepCx * c.z) * scale;
    const float zy = (stepAy * a.z + stepBy * b.z + stepCy * c.z) * scale;
    float rowZ = (rowA * a.z + rowB * b.z + rowC * c.z) * scale;
    for (int y = y0; y <= y1; ++y) {
      // Columns where all edge functions are ≥ 0, from the row's start.
      float low = 0.0F;
      float high = static_cast<float>(x1 - x0);
      const auto cut = [&](float value, float step) {
        if (step > 0.0F) {
          low = std::max(low, -value / step);
        } else if (step < 0.0F) {
          high = std::min(high, -value / step);
        } else if (value < 0.0F) {
          high = -1.0F;
        }
      };
      cut(rowA, stepAx);
      cut(rowB, stepBx);
      cut(rowC, stepCx);
      if (low <= high) {
        const auto first = static_cast<int>(std::ceil(low));
        const auto last = static_cast<int>(high);
        float* row = pixels + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x0;
        for (int x = first; x <= last; ++x)
          row[x] = std::max(row[x], rowZ + static_cast<float>(x) * zx);
      }
      rowA += stepAy;
      rowB += stepBy;
      rowC += stepCy;
      rowZ += zy;
    }
  }
};

}  // namespace

void drawNearness(
    std::span<const glm::uvec3> triangles,
    std::span<const glm::vec3> projected,
    Occluders occluders,
    NearnessImage& image) {
  image.nearness.assign(
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
      -std::numeric_limits<float>::infinity());
  const Raster raster{image.width, image.height, image.nearness.data()};
  for (const glm::uvec3& t : triangles) {
    const glm::vec3& a = projected[t.x];
    const glm::vec3& b = projected[t.y];
    const glm::vec3& c = projected[t.z];
    const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0.0F || (area > 0.0F && occluders == Occluders::kFrontFaces)) continue;
    if (a.z == 0.0F || b.z == 0.0F || c.z == 0.0F) continue;
    raster.triangle(a, b, c, area);
  }
}

}  // namespace limn
