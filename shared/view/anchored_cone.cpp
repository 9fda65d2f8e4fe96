// SPDX-License-Identifier: Apache-2.0
// Based on: P. V. Sander, X. Gu, S. J. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping",
// SIGGRAPH 2000, section 5 (anchored cones).
// Deviations: the apexes lie on one common line, found by one pass over the planes instead of two
// linear programs: a test then needs one axis offset instead of two, and clusters can be refitted
// in a frame. The axis is an approximate centre of the normals instead of Gilbert's exact one.
#include "shared/view/anchored_cone.h"

#include "shared/view/normal_cone.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace limn {
AnchoredCone
fitAnchoredCone(std::span<const glm::vec4> planes, const glm::vec3& center, double tangentScale) {
  std::vector<glm::dvec3> normals(planes.size());
  std::vector<double> offsets(planes.size());
  bool hasZero = false;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const glm::dvec3 n(planes[i]);
    const double length = glm::length(n);
    hasZero |= length == 0.0;
    normals[i] = length == 0.0 ? n : n / length;
    offsets[i] = length == 0.0 ? 0.0 : planes[i].w / length;
  }
  const NormalCone normalCone = fitNormalCone(normals);
  AnchoredCone cone;
  cone.center = center;
  if (hasZero || normalCone.cosHalf < ConeSlack::kMinCosine) return cone;
  cone.axis = glm::vec3(normalCone.axis);
  // What is stored is rounded: measure against that.
  const glm::dvec3 axis(cone.axis);
  const glm::dvec3 middle(center);
  double front = -std::numeric_limits<double>::max();
  double back = std::numeric_limits<double>::max();
  double cosHalf = 1.0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const double cosine = glm::dot(normals[i], axis);
    const double apex = -(glm::dot(normals[i], middle) + offsets[i]) / cosine;
    front = std::max(front, apex);
    back = std::min(back, apex);
    cosHalf = std::min(cosHalf, cosine);
  }
  const double sineSquared = std::max(1.0 - cosHalf * cosHalf, 1e-8);
  const double cotSquared = cosHalf * cosHalf / sineSquared / (tangentScale * tangentScale);
  cone.front = static_cast<float>(front);
  cone.back = static_cast<float>(back);
  cone.cotSquared = static_cast<float>(cotSquared * (1.0 - 1e-5));
  return cone;
}

ConeSide sideOf(const AnchoredCone& cone, const glm::vec4& eye, float extent) {
  const float slack = ConeSlack::kDistance * (glm::length(glm::vec3(eye)) + extent * eye.w);
  const glm::vec3 q = glm::vec3(eye) - cone.center * eye.w;
  const float along = glm::dot(q, cone.axis);
  const float square = glm::dot(q, q);
  const float across = (square - along * along) + ConeSlack::kSquare * square;
  const float inFront = (along - cone.front * eye.w) - slack;
  const float inBack = (along - cone.back * eye.w) + slack;
  if (inFront > 0.0F && inFront * inFront * cone.cotSquared >= across) return ConeSide::kFront;
  if (inBack < 0.0F && inBack * inBack * cone.cotSquared >= across) return ConeSide::kBack;
  return ConeSide::kUnknown;
}

}  // namespace limn
