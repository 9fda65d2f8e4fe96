// SPDX-License-Identifier: Apache-2.0
#include "client/svg/clear_runs.h"

#include "client/stroke/line_halo.h"
#include "client/svg/run_steps.h"

#include <utility>

namespace limn {
namespace {

/// As far apart as the picture's samples.
constexpr float kStepPx = 1.0F;

/// Remainders as short as this are specks.
constexpr float kShortestPx = 1.5F;

/// What is left of one run.
void cutRun(const VisibleRun& run, const LineHalo& halo, std::vector<VisibleRun>& out) {
  const VisibleRun none{{}, run.spine, 0.0F, false, false};
  bool isWhole = true;
  VisibleRun piece = none;
  float length = 0.0F;
  const auto finish = [&] {
    if (length > kShortestPx) out.push_back(std::move(piece));
    piece = none;
    length = 0.0F;
  };
  alongRun(run, kStepPx, [&](const RunStep& step) {
    if (halo.isNear(step.middle())) {
      isWhole = false;
      finish();
    } else {
      addStep(step, piece);
      length += step.length;
    }
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
    if (run.visible) alongRun(run, kStepPx, [&](const RunStep& step) { halo.add(step.middle()); });
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
