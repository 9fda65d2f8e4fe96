// SPDX-License-Identifier: Apache-2.0
// Based on: Y. Ohtake, A. Belyaev, H.-P. Seidel, "Ridge-Valley Lines on Meshes via Implicit Surface
// Fitting", SIGGRAPH 2004, for the lines; curvature and its derivative per vertex instead of a
// fitted surface, and the limits, are those of rtsc (DeCarlo et al.).
#include "shared/silhouette/ridges.h"

#include <array>
#include <cmath>

namespace limn {
namespace {

class RidgeSearch {
 public:
  RidgeSearch(
      const HalfEdgeMesh& mesh,
      std::span<const glm::ivec3> positions,
      const SurfaceCurvature& curvature,
      RidgeKind kind,
      float threshold)
      : mesh_(mesh),
        positions_(positions),
        curvature_(curvature),
        sign_(kind == RidgeKind::kRidge ? 1.0F : -1.0F),
        threshold_(threshold / curvature.featureSize) {}

  std::vector<SurfaceSegment> run() {
    for (FaceId face = 0; face < mesh_.faceCount(); ++face)
      search(face);
    return std::move(segments_);
  }

 private:
  [[nodiscard]] glm::vec3 at(std::uint32_t v) const { return glm::vec3(positions_[v]); }

  /// Along the principal direction, the way in which the curvature grows in size.
  [[nodiscard]] glm::vec3 growth(std::uint32_t v) const {
    return sign_ * curvature_.derivatives[v].x * curvature_.directions1[v];
  }

  /// Whether the curvature has its extremum of the right kind between two vertices.
  [[nodiscard]] bool isCrossed(std::uint32_t a, std::uint32_t b) const {
    const glm::vec3 fromA = growth(a);
    const glm::vec3 fromB = growth(b);
    if (glm::dot(fromA, fromB) > 0.0F) return false;
    const glm::vec3 along = at(b) - at(a);
    return glm::dot(fromA, along) >= 0.0F || glm::dot(fromB, along) <= 0.0F;
  }

  [[nodiscard]] float strengthOf(float curvature) const {
    const float surplus = std::abs(curvature) - threshold_;
    return surplus > 0.0F ? surplus / (surplus + threshold_) : 0.0F;
  }

  [[nodiscard]] SurfaceSegment::End crossing(HalfEdgeId h) const {
    // From the lower vertex always, so that both faces of an edge have one point.
    const std::uint32_t a = std::min(mesh_.origin(h), mesh_.target(h));
    const std::uint32_t b = std::max(mesh_.origin(h), mesh_.target(h));
    const float growthA = std::abs(curvature_.derivatives[a].x);
    const float growthB = std::abs(curvature_.derivatives[b].x);
    const float sum = growthA + growthB;
    const float t = sum > 0.0F ? growthA / sum : 0.5F;
    const float k =
        curvature_.curvatures[a].x + t * (curvature_.curvatures[b].x - curvature_.curvatures[a].x);
    return {edgeNode(mesh_, h), at(a) + t * (at(b) - at(a)), strengthOf(k)};
  }

  void search(FaceId face) {
    const std::uint32_t* corners = &mesh_.origins[3 * std::size_t{face}];
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (curvature_.isKnown[corners[k]] == 0) return;
      if (!(sign_ * curvature_.curvatures[corners[k]].x > 0.0F)) return;
    }
    std::array<SurfaceSegment::End, 3> ends;
    std::size_t count = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (isCrossed(corners[k], corners[(k + 1) % 3])) ends[count++] = crossing(3 * face + k);
    }
    if (count < 2) return;
    if (count == 2) {
      emit(face, ends[0], ends[1]);
      return;
    }
    SurfaceSegment::End centre;
    centre.node = static_cast<std::uint32_t>(mesh_.origins.size()) + face;
    centre.point = (ends[0].point + ends[1].point + ends[2].point) / 3.0F;
    centre.strength = (ends[0].strength + ends[1].strength + ends[2].strength) / 3.0F;
    for (const SurfaceSegment::End& end : ends)
      emit(face, end, centre);
  }

  void emit(FaceId face, const SurfaceSegment::End& a, const SurfaceSegment::End& b) {
    if (a.strength > 0.0F || b.strength > 0.0F) segments_.push_back({face, {a, b}});
  }

  const HalfEdgeMesh& mesh_;
  std::span<const glm::ivec3> positions_;
  const SurfaceCurvature& curvature_;
  float sign_;
  float threshold_;
  std::vector<SurfaceSegment> segments_;
};

}  // namespace

std::vector<SurfaceSegment> findRidges(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    const SurfaceCurvature& curvature,
    RidgeKind kind,
    float threshold) {
  return RidgeSearch(mesh, positions, curvature, kind, threshold).run();
}

}  // namespace limn
