// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/spine.h"

#include "shared/core/camera.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// How far, in pixels, each small outline lies over larger ones and nearer to the eye: a bump's
/// contour, which is the outline there, as what it covers is hidden. Only of spines that are small,
/// against outlines that are not, no farther behind than a bump is high; else 0. isSmall and the
/// result: parallel to SpineSet::spines. Cost: O(length of outlines in pixels), nothing where
/// nothing is small.
[[nodiscard]] std::vector<float> coveredLengths(
    const SpineSet& spines,
    std::span<const std::uint8_t> isSmall,
    const Camera& camera,
    const Viewport& viewport);

}  // namespace limn
