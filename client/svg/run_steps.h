// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/svg/visible_runs.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace limn {

/// A short straight piece of a run; pixels.
struct RunStep {
  glm::vec2 from{0.0F};
  glm::vec2 to{0.0F};
  float arc = 0.0F;  // of `from`, along the spine
  float length = 0.0F;

  [[nodiscard]] glm::vec2 middle() const { return 0.5F * (from + to); }
};

/// visit(RunStep) for pieces of a run up to stepPx long, one after another.
template <class Visit>
void alongRun(const VisibleRun& run, float stepPx, Visit visit) {
  const std::size_t count = run.points.size();
  float arc = run.arc;
  for (std::size_t i = 0; i + 1 < count + (run.closed ? 1 : 0); ++i) {
    const glm::vec2 from = run.points[i];
    const glm::vec2 to = run.points[(i + 1) % count];
    const float length = glm::distance(from, to);
    const float steps = std::max(1.0F, std::ceil(length / stepPx));
    for (float k = 0.0F; k < steps; ++k) {
      visit(RunStep{
          glm::mix(from, to, k / steps),
          glm::mix(from, to, (k + 1.0F) / steps),
          arc + length * k / steps,
          length / steps});
    }
    arc += length;
  }
}

/// Adds a step to what becomes a run; a point that a straight line passes through goes.
inline void addStep(const RunStep& step, VisibleRun& run) {
  /// Pixels beside a line that are none.
  constexpr float kStraight = 1e-3F;
  std::vector<glm::vec2>& points = run.points;
  if (points.empty()) {
    points.push_back(step.from);
    run.arc = step.arc;
  } else if (points.size() > 1) {
    const glm::vec2 last = points.back() - points[points.size() - 2];
    const glm::vec2 next = step.to - points.back();
    const float cross = last.x * next.y - last.y * next.x;
    if (std::abs(cross) < kStraight * glm::length(last) && glm::dot(last, next) > 0.0F)
      points.pop_back();
  }
  points.push_back(step.to);
}

}  // namespace limn
