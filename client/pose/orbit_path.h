// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/pose/orbit.h"

#include "shared/core/camera.h"

#include <cstdint>
#include <vector>

namespace limn {

/// A camera a frame.
using CameraPath = std::vector<Camera>;

/// Once around the model at constant elevation and distance, `frames` cameras, starting at `start`:
/// frame i is i / frames of a turn further. Depth ranges are fitted.
[[nodiscard]] CameraPath
orbitPath(const BoundingSphere& model, const Orbit& start, double fovDegrees, std::uint32_t frames);

}  // namespace limn
