// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/bench/plain_mesh.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace limn::bench {

/// Distances between drawn contours, in pixels, both ways.
struct ContourError {
  double mean = 0.0;
  double rms = 0.0;
  double p95 = 0.0;
};

/// The visible contours (silhouette edges and borders) of a mesh from a number of viewpoints spread
/// evenly over a sphere of three radii, and how far other meshes' contours are from them. A pixel
/// that is farther than kFar from the other picture's contours counts as kFar away: contours that
/// the other mesh has not at all.
class ContourReference {
 public:
  static constexpr double kFar = 32.0;

  /// size: width and height of the pictures.
  ContourReference(const PlainMesh& mesh, std::uint32_t views, std::uint32_t size);
  ~ContourReference();

  /// Cost: about 20 ms a view of 1024².
  [[nodiscard]] ContourError compare(const PlainMesh& mesh) const;

 private:
  struct View;
  std::uint32_t size_;
  std::vector<View> views_;
};

}  // namespace limn::bench
