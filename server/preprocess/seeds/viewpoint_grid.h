// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace limn {

/// Where a viewpoint stands on the sphere around a model, degrees, as in orbitCamera().
struct Viewpoint {
  double azimuth = 0.0;
  double elevation = 0.0;
};

/// azimuths × elevations viewpoints: the latter in the middles of as many bands from pole to pole.
[[nodiscard]] std::vector<Viewpoint> viewpointGrid(int azimuths, int elevations);

/// What is lost, 0 … 1, at a viewpoint, with the viewpoints that were added so far.
using LossAt = std::function<double(const Viewpoint&)>;

struct DensifyOptions {
  std::uint32_t most = 0;   // viewpoints to add, at most
  double tolerated = 0.01;  // a loss that is no reason for a viewpoint
  int deepest = 3;          // how often a cell of the grid is quartered, at most
};

/// Makes a grid denser where it loses most: the middle of each of its cells is judged, the worst
/// one becomes a viewpoint, its cell is quartered, and so on. Calls add() for each. Deterministic.
void densify(
    int azimuths,
    int elevations,
    const DensifyOptions& options,
    const LossAt& lossAt,
    const std::function<void(const Viewpoint&)>& add);

}  // namespace limn
