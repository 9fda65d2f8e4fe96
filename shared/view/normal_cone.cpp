// SPDX-License-Identifier: Apache-2.0
#include "shared/view/normal_cone.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr int kRefinements = 8;

struct Farthest {
  glm::dvec3 normal{0.0};
  double cosine = 2.0;
};

Farthest farthestFrom(const glm::dvec3& axis, std::span<const glm::dvec3> normals) {
  Farthest farthest;
  for (const glm::dvec3& n : normals) {
    const double cosine = glm::dot(axis, n);
    if (cosine < farthest.cosine && n != glm::dvec3(0.0)) farthest = {n, cosine};
  }
  return farthest;
}

}  // namespace

NormalCone fitNormalCone(std::span<const glm::dvec3> normals) {
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& n : normals)
    sum += n;
  if (glm::dot(sum, sum) < 1e-12) return {};
  NormalCone best{glm::normalize(sum), -1.0};
  glm::dvec3 axis = best.axis;
  for (int i = 0;; ++i) {
    const Farthest farthest = farthestFrom(axis, normals);
    if (farthest.cosine > best.cosHalf) best = {axis, std::min(farthest.cosine, 1.0)};
    if (i == kRefinements || farthest.cosine > 0.9999) return best;
    axis += (farthest.normal - axis) / (i + 3.0);
    const double length = glm::length(axis);
    if (length < 1e-6) return best;
    axis /= length;
  }
}

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
