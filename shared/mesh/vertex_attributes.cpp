// SPDX-License-Identifier: Apache-2.0
//
// Based on: Q. Meyer, J. Süßmuth, G. Sußner, M. Stamminger, G. Greiner, "On floating-point normal
// vectors", EGSR 2010 (octahedral normals); IEC 61966-2-1 (sRGB).
#include "shared/mesh/vertex_attributes.h"

#include <algorithm>
#include <cmath>

namespace limn {

OctNormal encodeNormal(const glm::dvec3& direction) {
  const glm::dvec3 unit = glm::normalize(direction);
  const glm::dvec3 size = glm::abs(unit);
  const glm::dvec3 scaled = unit * (kOctRadius / (size.x + size.y + size.z));
  glm::dvec2 st(scaled.x, scaled.y);
  if (scaled.z < 0.0) {
    st = {
        std::copysign(kOctRadius - std::abs(scaled.y), scaled.x),
        std::copysign(kOctRadius - std::abs(scaled.x), scaled.y)};
  }
  const glm::ivec2 corner(glm::floor(st));
  glm::ivec2 best(0);
  double bestCosine = -2.0;
  for (int i = 0; i < 4; ++i) {
    const glm::ivec2 candidate =
        glm::clamp(corner + glm::ivec2(i & 1, i >> 1), -kOctRadius, kOctRadius);
    const double cosine = glm::dot(glm::normalize(glm::dvec3(octPoint(candidate))), unit);
    if (cosine > bestCosine) {
      bestCosine = cosine;
      best = candidate;
    }
  }
  // Points on the fold have two names: take the one that unfolding gives.
  return octNormal(octPoint(best));
}

glm::vec3 decodeNormal(const OctNormal& normal) {
  return glm::normalize(glm::vec3(octPoint(normal)));
}

std::uint8_t srgbFromLinear(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * srgb));
}

}  // namespace limn
