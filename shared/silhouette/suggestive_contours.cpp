// SPDX-License-Identifier: Apache-2.0
// Based on: D. DeCarlo, A. Finkelstein, S. Rusinkiewicz, A. Santella, "Suggestive Contours for
// Conveying Shape", SIGGRAPH 2003; D. DeCarlo, A. Finkelstein, S. Rusinkiewicz, "Interactive
// Rendering of Suggestive Contours with Temporal Coherence", NPAR 2004, for the threshold on the
// derivative times sin θ / cos θ and for fading; as the authors' program rtsc does it.
#include "shared/silhouette/suggestive_contours.h"

#include <array>
#include <utility>

namespace limn {
namespace {

/// Signs of a vertex's values. A line crosses a face whose corners' curvatures differ in sign, and
/// shows where corners face the eye and pass the test.
constexpr std::uint8_t kConvex = 1;
constexpr std::uint8_t kConcave = 2;
constexpr std::uint8_t kFacing = 4;
constexpr std::uint8_t kPassing = 8;
constexpr std::uint8_t kUnknown = 16;
constexpr std::uint8_t kCrossed = kConvex | kConcave | kFacing | kPassing;

}  // namespace

void SuggestiveContours::evaluate(const SilhouetteView& view) {
  const float threshold = options_.threshold / (curvature_.featureSize * curvature_.featureSize);
  values_.resize(mesh_.vertexCount());
  signs_.assign(mesh_.vertexCount(), kUnknown);
  for (std::uint32_t i = 0; i < values_.size(); ++i) {
    Value& value = values_[i];
    value = {};
    if (curvature_.isKnown[i] == 0) continue;
    const glm::dvec3 away =
        view.orthographic ? -view.forward : view.eye - glm::dvec3(positions_[i]);
    const glm::vec3 toEye(glm::normalize(away));
    value.facing = glm::dot(toEye, curvature_.normals[i]);
    const float u = glm::dot(toEye, curvature_.directions1[i]);
    const float v = glm::dot(toEye, curvature_.directions2[i]);
    const float u2 = u * u;
    const float v2 = v * v;
    const glm::vec2 k = curvature_.curvatures[i];
    value.curvature = k.x * u2 + k.y * v2;
    signs_[i] = value.curvature > 0.0F ? kConvex : kConcave;
    if (value.facing > 0.0F) signs_[i] |= kFacing;
    const float sine2 = u2 + v2;
    // Straight from above there is no radial direction.
    if (!(sine2 > 1e-8F)) continue;
    const glm::vec4& c = curvature_.derivatives[i];
    const float torsion = (k.y - k.x) * u * v / sine2;
    const float along = (u2 * (u * c.x + 3.0F * v * c.y) + v2 * (3.0F * u * c.z + v * c.w)) / sine2;
    value.derivative = along - 2.0F * value.facing * torsion * torsion - threshold * value.facing;
    if (value.derivative > 0.0F) signs_[i] |= kPassing;
  }
}

void SuggestiveContours::cross(FaceId face) {
  const std::uint32_t* corners = &mesh_.origins[3 * std::size_t{face}];
  const unsigned signs = signs_[corners[0]] | signs_[corners[1]] | signs_[corners[2]];
  if (signs != kCrossed) return;
  const std::array<Value, 3> at{values_[corners[0]], values_[corners[1]], values_[corners[2]]};
  const float fade = options_.fade / (curvature_.featureSize * curvature_.featureSize);
  // It runs with the side that curves towards the eye to its left.
  SurfaceSegment segment;
  segment.face = face;
  std::size_t ends = 0;
  std::array<float, 2> facings{};
  std::array<float, 2> derivatives{};
  for (std::uint32_t k = 0; k < 3; ++k) {
    std::uint32_t a = k;
    std::uint32_t b = (k + 1) % 3;
    if ((at[a].curvature > 0.0F) == (at[b].curvature > 0.0F)) continue;
    // From the positive end always, so that both faces of an edge have one point.
    const std::size_t end = at[a].curvature > 0.0F ? 0 : 1;
    if (end == 1) std::swap(a, b);
    const float t = at[a].curvature / (at[a].curvature - at[b].curvature);
    const glm::vec3 from(positions_[corners[a]]);
    const glm::vec3 to(positions_[corners[b]]);
    segment.ends[end].node = edgeNode(mesh_, 3 * face + k);
    segment.ends[end].point = from + t * (to - from);
    facings[end] = at[a].facing + t * (at[b].facing - at[a].facing);
    derivatives[end] = at[a].derivative + t * (at[b].derivative - at[a].derivative);
    ++ends;
  }
  if (ends < 2) return;
  bool isSeen = false;
  for (std::size_t e = 0; e < 2; ++e) {
    const float surplus = facings[e] > 0.0F ? derivatives[e] : 0.0F;
    isSeen = isSeen || surplus > 0.0F;
    segment.ends[e].strength = surplus <= 0.0F ? 0.0F
                               : fade > 0.0F   ? surplus / (surplus + facings[e] * fade)
                                               : 1.0F;
  }
  if (isSeen) segments_.push_back(segment);
}

std::span<const SurfaceSegment> SuggestiveContours::find(const SilhouetteView& view) {
  evaluate(view);
  segments_.clear();
  for (FaceId face = 0; face < mesh_.faceCount(); ++face)
    cross(face);
  return segments_;
}

}  // namespace limn
