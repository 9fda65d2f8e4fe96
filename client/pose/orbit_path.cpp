// SPDX-License-Identifier: Apache-2.0
#include "client/pose/orbit_path.h"

namespace limn {

CameraPath orbitPath(
    const BoundingSphere& model,
    const Orbit& start,
    double fovDegrees,
    std::uint32_t frames) {
  CameraPath path;
  path.reserve(frames);
  for (std::uint32_t i = 0; i < frames; ++i) {
    const double turn = 360.0 * i / frames;
    path.push_back(orbitCamera(
        model,
        start.azimuthDegrees + turn,
        start.elevationDegrees,
        start.distanceRadii,
        fovDegrees));
  }
  return path;
}

}  // namespace limn
