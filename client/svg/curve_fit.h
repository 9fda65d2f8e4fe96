// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <span>
#include <vector>

namespace limn {

/// One step of a path: a straight line to `to`, or a cubic Bézier curve.
struct PathStep {
  glm::dvec2 control1{0.0};  // curves only
  glm::dvec2 control2{0.0};
  glm::dvec2 to{0.0};
  bool isCurve = false;
};

struct FittedPath {
  glm::dvec2 start{0.0};
  std::vector<PathStep> steps;
};

enum class PathEnds { kOpen, kClosed };

struct FitOptions {
  double tolerancePx = 0.24;         // between polyline and path, either way
  double cornerAngleDegrees = 40.0;  // sharper turns stay corners
  double cornerReachPx = 2.5;        // a turn is measured over this much on both sides
};

/// The shortest path of lines and smooth curves that runs within the tolerance of a polyline: from
/// corner to corner whichever of the two needs fewer numbers. Ends and corners stay where they are.
/// kClosed: the first point is not repeated; the path then ends where it starts.
/// points: 2 or more. Cost: O(n log n) for usual lines.
[[nodiscard]] FittedPath
fitPath(std::span<const glm::vec2> points, PathEnds ends, const FitOptions& options = {});

}  // namespace limn
