// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/line_density.h"
#include "client/svg/visible_runs.h"

#include <vector>

namespace limn {

/// What lines lie where. hiddenAsVisible: hidden runs count among the visible ones.
[[nodiscard]] LineDensity
densityOf(const std::vector<VisibleRun>& runs, const Viewport& viewport, bool hiddenAsVisible);

/// What a run keeps of itself among others, in the mean: one path has one width and one opacity.
[[nodiscard]] Crowding
crowdingOf(const VisibleRun& run, bool isVisible, const LineDensity& density, float widthPx);

/// Appends a hidden run, cut where it pales by much, so that one opacity does for each part.
/// Cost: O(length in pixels).
void cutWherePaler(
    const VisibleRun& run,
    const LineDensity& density,
    float widthPx,
    std::vector<VisibleRun>& out);

}  // namespace limn
