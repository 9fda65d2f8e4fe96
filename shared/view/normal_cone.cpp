// SPDX-License-Identifier: Apache-2.0
#include "shared/view/normal_cone.h"

#include <algorithm>

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

}  // namespace limn
