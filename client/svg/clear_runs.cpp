// SPDX-License-Identifier: Apache-2.0
#include "client/svg/clear_runs.h"

#include "client/stroke/line_halo.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace limn {
namespace {

/// As far apart as the picture's samples.
constexpr float kStepPx = 1.0F;

/// Remainders as short as this are specks.
constexpr float kShortestPx = 1.5F;

/// Pixels beside a line that are none.
constexpr float kStraight = 1e-3F;

/// visit(begin, end, distance of begin from the run's start, length) for short pieces of a run.
template <class Visit>
void alongRun(const VisibleRun& run, Visit visit) {
  const std::size_t count = run.points.size();
  float at = 0.0F;
  for (std::size_t i = 0; i + 1 < count + (run.closed ? 1 : 0); ++i) {
    const glm::vec2 from = run.points[i];
    const glm::vec2 to = run.points[(i + 1) % count];
    const float length = glm::distance(from, to);
    const float steps = std::max(1.0F, std::ceil(length / kStepPx));
    for (float k = 0.0F; k < steps; ++k) {
      visit(
          glm::mix(from, to, k / steps),
          glm::mix(from, to, (k + 1.0F) / steps),
          at + length * k / steps,
          length / steps);
    }
    at += length;
  }
}

/// Adds a point; one before it that a straight line passes through goes.
void addPoint(const glm::vec2& point, std::vector<glm::vec2>& points) {
  if (points.size() > 1) {
    const glm::vec2 last = points.back() - points[points.size() - 2];
    const glm::vec2 next = point - points.back();
    const float cross = last.x * next.y - last.y * next.x;
    if (std::abs(cross) < kStraight * glm::length(last) && glm::dot(last, next) > 0.0F)
      points.pop_back();
  }
  points.push_back(point);
}

/// What is left of one run.
void cutRun(const VisibleRun& run, const LineHalo& halo, std::vector<VisibleRun>& out) {
  bool isWhole = true;
  float length = 0.0F;  // of the piece at hand; 0: none
  VisibleRun piece;
  const auto finish = [&] {
    if (length > kShortestPx) out.push_back(std::move(piece));
    piece = {{}, run.spine, 0.0F, false, false};
    length = 0.0F;
  };
  alongRun(run, [&](const glm::vec2& from, const glm::vec2& to, float at, float step) {
    if (halo.isNear(0.5F * (from + to))) {
      isWhole = false;
      finish();
      return;
    }
    if (piece.points.empty()) {
      piece = {{from}, run.spine, run.arc + at, false, false};
    }
    addPoint(to, piece.points);
    length += step;
  });
  if (isWhole) {
    out.push_back(run);
  } else {
    finish();
  }
}

}  // namespace

std::vector<VisibleRun>
clearOfVisible(const std::vector<VisibleRun>& runs, const Viewport& viewport, float widthPx) {
  LineHalo halo(viewport, widthPx);
  for (const VisibleRun& run : runs) {
    if (!run.visible) continue;
    alongRun(run, [&](const glm::vec2& from, const glm::vec2& to, float, float) {
      halo.add(0.5F * (from + to));
    });
  }
  std::vector<VisibleRun> clear;
  for (const VisibleRun& run : runs) {
    if (run.visible) {
      clear.push_back(run);
    } else {
      cutRun(run, halo, clear);
    }
  }
  return clear;
}

}  // namespace limn
