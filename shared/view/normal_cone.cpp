// SPDX-License-Identifier: Apache-2.0
#include "shared/view/normal_cone.h"

#include <algorithm>
#include <cmath>

namespace limn {

NormalCone mergedCone(const NormalCone& a, const NormalCone& b) {
  constexpr double kSlack = 1e-12;
  if (a.cosHalf <= 0.0 || b.cosHalf <= 0.0) return {};
  const auto sineOf = [](double cosine) { return std::sqrt(std::max(0.0, 1.0 - cosine * cosine)); };
  const double cosA = std::min(a.cosHalf, 1.0);
  const double cosB = std::min(b.cosHalf, 1.0);
  const double cosAxes = std::clamp(glm::dot(a.axis, b.axis), -1.0, 1.0);
  const double sinA = sineOf(cosA);
  const double sinB = sineOf(cosB);
  const double sinAxes = sineOf(cosAxes);
  // Is one inside the other? Half-angle plus angle of the axes, if that is no more than π.
  if (sinAxes * cosB + cosAxes * sinB >= 0.0 && cosAxes * cosB - sinAxes * sinB >= cosA) return a;
  if (sinAxes * cosA + cosAxes * sinA >= 0.0 && cosAxes * cosA - sinAxes * sinA >= cosB) return b;
  // The whole opening: both half-angles and the angle of the axes.
  const double cosBoth = cosA * cosB - sinA * sinB;
  const double sinBoth = sinA * cosB + cosA * sinB;
  const double sinOpening = sinBoth * cosAxes + cosBoth * sinAxes;
  if (sinOpening <= 0.0 || sinAxes < 1e-9) return {};
  const double cosOpening = cosBoth * cosAxes - sinBoth * sinAxes;
  const double cosHalf = std::sqrt(0.5 * (1.0 + cosOpening));
  // a's axis turns towards b's by what the cone grows beyond a's far side.
  const double sinHalf = sineOf(cosHalf);
  const double cosTurn = cosHalf * cosA + sinHalf * sinA;
  const double sinTurn = sinHalf * cosA - cosHalf * sinA;
  const glm::dvec3 across = (b.axis - cosAxes * a.axis) / sinAxes;
  return {glm::normalize(cosTurn * a.axis + sinTurn * across), cosHalf - kSlack};
}

}  // namespace limn
