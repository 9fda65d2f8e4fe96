// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <string_view>

namespace limn {

/// A camera on a sphere around the model; see orbitCamera().
struct Orbit {
  double azimuthDegrees = 30.0;
  double elevationDegrees = 20.0;
  double distanceRadii = 3.0;
};

/// Parses `orbit:AZIMUTH,ELEVATION[,DISTANCE]`, degrees and radii; elevation −90 to 90, distance
/// above 0. Errors: kInvalidArgument, with an example.
[[nodiscard]] Result<Orbit> parseOrbit(std::string_view text);

}  // namespace limn
