// SPDX-License-Identifier: Apache-2.0
#include "client/svg/crowded_runs.h"

#include "client/svg/run_steps.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

constexpr float kStepPx = 4.0F;

/// The darkest place of a part is at most this many times as dark as its palest.
constexpr float kMostContrast = 2.0F;

}  // namespace

LineDensity
densityOf(const std::vector<VisibleRun>& runs, const Viewport& viewport, bool hiddenAsVisible) {
  LineDensity density(viewport);
  for (const VisibleRun& run : runs) {
    alongRun(run, kStepPx, [&](const RunStep& step) {
      density.add(step.middle(), run.visible || hiddenAsVisible, step.length);
    });
  }
  return density;
}

Crowding
crowdingOf(const VisibleRun& run, bool isVisible, const LineDensity& density, float widthPx) {
  Crowding sum{0.0F, 0.0F};
  float total = 0.0F;
  alongRun(run, kStepPx, [&](const RunStep& step) {
    const glm::vec2 d = density.at(step.middle());
    const Crowding here =
        isVisible ? crowdingOfVisible(d.x, widthPx) : crowdingOfHidden(d.y, widthPx);
    sum.width += step.length * here.width;
    sum.opacity += step.length * here.opacity;
    total += step.length;
  });
  if (!(total > 0.0F)) return {};
  return {sum.width / total, sum.opacity / total};
}

void cutWherePaler(
    const VisibleRun& run,
    const LineDensity& density,
    float widthPx,
    std::vector<VisibleRun>& out) {
  const VisibleRun none{{}, run.spine, 0.0F, run.visible, false};
  bool isWhole = true;
  VisibleRun part = none;
  float palest = 1.0F;
  float darkest = 0.0F;
  alongRun(run, kStepPx, [&](const RunStep& step) {
    const float here = crowdingOfHidden(density.at(step.middle()).y, widthPx).opacity;
    palest = std::min(palest, here);
    darkest = std::max(darkest, here);
    if (darkest > kMostContrast * palest) {
      isWhole = false;
      out.push_back(std::move(part));
      part = none;
      palest = darkest = here;
    }
    addStep(step, part);
  });
  out.push_back(isWhole ? run : std::move(part));
}

}  // namespace limn
