// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/seeds/viewpoint_grid.h"

#include <algorithm>

namespace limn {
namespace {

// A part of the sphere and what is lost in its middle.
struct Cell {
  Viewpoint low;
  Viewpoint high;
  int depth = 0;
  double loss = 0.0;

  [[nodiscard]] Viewpoint middle() const {
    // The cells at a pole have it for their middle, all of them.
    if (low.elevation <= -90.0 && depth == 0) return {0.0, -90.0};
    if (high.elevation >= 90.0 && depth == 0) return {0.0, 90.0};
    return {0.5 * (low.azimuth + high.azimuth), 0.5 * (low.elevation + high.elevation)};
  }
};

std::vector<Cell> cellsOf(int azimuths, int elevations) {
  const double across = 360.0 / azimuths;
  const double up = 180.0 / elevations;
  std::vector<Cell> cells = {
      {{0.0, -90.0}, {360.0, -90.0 + 0.5 * up}, 0, 0.0},
      {{0.0, 90.0 - 0.5 * up}, {360.0, 90.0}, 0, 0.0}};
  for (int e = 0; e + 1 < elevations; ++e) {
    for (int a = 0; a < azimuths; ++a) {
      const double elevation = up * (e + 0.5) - 90.0;
      cells.push_back({{across * a, elevation}, {across * (a + 1), elevation + up}, 0, 0.0});
    }
  }
  return cells;
}

std::vector<Cell> quarters(const Cell& cell) {
  const Viewpoint middle{
      0.5 * (cell.low.azimuth + cell.high.azimuth),
      0.5 * (cell.low.elevation + cell.high.elevation)};
  const int depth = cell.depth + 1;
  return {
      {cell.low, middle, depth, 0.0},
      {{middle.azimuth, cell.low.elevation}, {cell.high.azimuth, middle.elevation}, depth, 0.0},
      {{cell.low.azimuth, middle.elevation}, {middle.azimuth, cell.high.elevation}, depth, 0.0},
      {middle, cell.high, depth, 0.0}};
}

}  // namespace

std::vector<Viewpoint> viewpointGrid(int azimuths, int elevations) {
  std::vector<Viewpoint> grid;
  for (int e = 0; e < elevations; ++e) {
    for (int a = 0; a < azimuths; ++a)
      grid.push_back({360.0 * a / azimuths, 180.0 * (e + 0.5) / elevations - 90.0});
  }
  return grid;
}

void densify(
    int azimuths,
    int elevations,
    const DensifyOptions& options,
    const LossAt& lossAt,
    const std::function<void(const Viewpoint&)>& add) {
  if (options.most == 0) return;
  std::vector<Cell> cells = cellsOf(azimuths, elevations);
  for (Cell& cell : cells)
    cell.loss = lossAt(cell.middle());
  for (std::uint32_t added = 0; added < options.most && !cells.empty(); ++added) {
    const auto worst =
        std::max_element(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) {
          return a.loss < b.loss;
        });
    if (worst->loss <= options.tolerated) return;
    const Cell cell = *worst;
    cells.erase(worst);
    add(cell.middle());
    if (cell.depth >= options.deepest) continue;
    for (Cell& quarter : quarters(cell)) {
      quarter.loss = lossAt(quarter.middle());
      cells.push_back(quarter);
    }
  }
}

}  // namespace limn
