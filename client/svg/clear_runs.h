// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/svg/visible_runs.h"

#include "shared/core/camera.h"

#include <vector>

namespace limn {

/// Cuts away what hidden runs have in the halos of visible ones (client/stroke/line_halo.h), as the
/// picture does; what is left of a run is one or more. widthPx: of an ordinary stroke.
/// Cost: O(length in pixels).
[[nodiscard]] std::vector<VisibleRun>
clearOfVisible(const std::vector<VisibleRun>& runs, const Viewport& viewport, float widthPx);

}  // namespace limn
