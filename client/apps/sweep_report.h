// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/detector.h"

#include <cstdint>
#include <string>
#include <vector>

namespace limn {

/// What one detector did in one frame of a sweep.
struct SweepFrame {
  double ms = 0.0;
  std::uint32_t segments = 0;
  std::uint32_t facesVisited = 0;
  double recall = 1.0;  // share of what there is to find
};

/// One detector along one mesh's path.
struct SweepSeries {
  DetectorMethod method = DetectorMethod::kBrute;
  double buildMs = 0.0;
  std::vector<SweepFrame> frames;

  [[nodiscard]] double medianMs() const;
  [[nodiscard]] double meanSegments() const;
  [[nodiscard]] double meanRecall() const;
  [[nodiscard]] double worstRecall() const;
};

struct SweepMesh {
  std::string name;
  std::uint32_t faces = 0;
  std::vector<SweepSeries> series;
};

/// A row a mesh, detector and frame, with a head.
[[nodiscard]] std::string sweepCsv(const std::vector<SweepMesh>& meshes);

/// A line a mesh and detector: medians and means, for people.
[[nodiscard]] std::string sweepTable(const std::vector<SweepMesh>& meshes);

/// Plots as one SVG: time, segments and recall against the frame, a row a mesh; below, median time
/// against the size of the mesh.
[[nodiscard]] std::string sweepPlot(const std::vector<SweepMesh>& meshes);

}  // namespace limn
