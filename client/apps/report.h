// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/session_state.h"
#include "client/render/renderer.h"

#include "shared/silhouette/detector.h"

#include <optional>
#include <string>
#include <vector>

namespace limn {

/// Milliseconds of one frame's parts.
struct FrameTimes {
  double detect = 0.0;
  double chain = 0.0;
  double stroke = 0.0;
  double visibility = 0.0;
  double draw = 0.0;

  [[nodiscard]] double total() const { return detect + chain + stroke + visibility + draw; }
};

struct ContourError {
  double p95 = 0.0;  // pixels
  double max = 0.0;
};

/// What `render --report` says.
struct RenderReport {
  const SessionOutcome* outcome = nullptr;
  std::string modelName;
  std::vector<FrameTimes> frames;
  std::string detectorName;
  DetectionStats stats;
  std::uint32_t loops = 0;
  std::optional<double> recall;
  std::optional<ContourError> contourError;
  std::optional<GlDescription> gl;
};

/// The report as commands.md lays it out, with the present peak memory of the process.
[[nodiscard]] std::string reportJson(const RenderReport& report);

}  // namespace limn
