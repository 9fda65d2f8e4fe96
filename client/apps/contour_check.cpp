// SPDX-License-Identifier: Apache-2.0
#include "client/apps/contour_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr double kSpacingPx = 0.5;
constexpr double kCellPx = 4.0;

/// Points in square cells over the picture, for nearest-point queries.
class PointGrid {
 public:
  PointGrid(std::span<const glm::dvec2> points, const Viewport& viewport)
      : points_(points),
        columns_(static_cast<int>(viewport.width / kCellPx) + 1),
        rows_(static_cast<int>(viewport.height / kCellPx) + 1),
        cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
    for (std::uint32_t i = 0; i < points.size(); ++i)
      cellAt(points[i]).push_back(i);
  }

  /// Distance to the nearest point; there must be one.
  [[nodiscard]] double distanceTo(const glm::dvec2& p) const {
    const auto [column, row] = clampedCell(p);
    double best = std::numeric_limits<double>::infinity();
    for (int ring = 0; ring <= columns_ + rows_; ++ring) {
      // Everything in ring r is at least (r − 1) cells away.
      if (best <= (ring - 1) * kCellPx) break;
      for (int y = row - ring; y <= row + ring; ++y) {
        if (y < 0 || y >= rows_) continue;
        const bool edge = y == row - ring || y == row + ring;
        for (int x = column - ring; x <= column + ring; x += edge || ring == 0 ? 1 : 2 * ring) {
          if (x < 0 || x >= columns_) continue;
          for (const std::uint32_t i : cells_[index(x, y)]) {
            best = std::min(best, glm::distance(p, points_[i]));
          }
        }
      }
    }
    return best;
  }

 private:
  [[nodiscard]] std::pair<int, int> clampedCell(const glm::dvec2& p) const {
    return {
        std::clamp(static_cast<int>(p.x / kCellPx), 0, columns_ - 1),
        std::clamp(static_cast<int>(p.y / kCellPx), 0, rows_ - 1)};
  }

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(x);
  }

  std::vector<std::uint32_t>& cellAt(const glm::dvec2& p) {
    const auto [x, y] = clampedCell(p);
    return cells_[index(x, y)];
  }

  std::span<const glm::dvec2> points_;
  int columns_;
  int rows_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

ContourError
oneWay(std::span<const glm::dvec2> from, std::span<const glm::dvec2> to, const Viewport& viewport) {
  const PointGrid grid(to, viewport);
  std::vector<double> distances;
  distances.reserve(from.size());
  for (const glm::dvec2& p : from)
    distances.push_back(grid.distanceTo(p));
  std::sort(distances.begin(), distances.end());
  const auto rank =
      static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(distances.size())));
  return {distances[std::max<std::size_t>(rank, 1) - 1], distances.back()};
}

bool inside(const glm::dvec3& p, const Viewport& viewport) {
  return p.x >= 0.0 && p.y >= 0.0 && p.x <= viewport.width && p.y <= viewport.height;
}

}  // namespace

std::vector<glm::dvec2> visibleSilhouettePixels(
    const PolylineSet& lines,
    std::span<const std::uint8_t> visible,
    const Grid& grid,
    const Camera& camera,
    const Viewport& viewport) {
  const glm::dmat4 clipFromWorld = camera.clipFromWorld(viewport.aspect());
  const auto clipOf = [&](std::uint32_t point) {
    const glm::dvec3 world = grid.origin + grid.step * glm::dvec3(lines.points[point]);
    return clipFromWorld * glm::dvec4(world, 1.0);
  };
  std::vector<glm::dvec2> pixels;
  for (const PolylineSet::Line& line : lines.lines) {
    if (line.kind != LineKind::kSilhouette) continue;
    for (std::uint32_t i = line.begin; i < line.begin + line.segmentCount(); ++i) {
      if (visible[i] == 0) continue;
      const glm::dvec4 a = clipOf(i);
      const glm::dvec4 b = clipOf(i + 1 == line.end ? line.begin : i + 1);
      if (a.w <= 0.0 || b.w <= 0.0) continue;
      const glm::dvec3 pa = pixelFromClip(a, viewport);
      const glm::dvec3 pb = pixelFromClip(b, viewport);
      const int steps = std::clamp(
          static_cast<int>(std::ceil(glm::distance(glm::dvec2(pa), glm::dvec2(pb)) / kSpacingPx)),
          1,
          100'000);
      for (int s = 0; s < steps; ++s) {
        const glm::dvec3 p = glm::mix(pa, pb, (s + 0.5) / steps);
        if (inside(p, viewport)) pixels.emplace_back(p);
      }
    }
  }
  return pixels;
}

ContourError compareContours(
    std::span<const glm::dvec2> a,
    std::span<const glm::dvec2> b,
    const Viewport& viewport) {
  if (a.empty() && b.empty()) return {};
  if (a.empty() || b.empty()) {
    const double diagonal = std::hypot(viewport.width, viewport.height);
    return {diagonal, diagonal};
  }
  const ContourError there = oneWay(a, b, viewport);
  const ContourError back = oneWay(b, a, viewport);
  return {std::max(there.p95, back.p95), std::max(there.max, back.max)};
}

}  // namespace limn
