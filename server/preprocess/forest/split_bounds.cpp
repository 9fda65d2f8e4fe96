// SPDX-License-Identifier: Apache-2.0
//
// Based on: H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (bounding
// spheres and normal cones of what a vertex stands for). The deviation is ours: the distance from
// each removed vertex to the surface that replaces it, added up along chains of collapses, so that
// it bounds the distance to the full mesh at the vertices.
#include "server/preprocess/forest/split_bounds.h"

#include "shared/mesh/closest_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace limn {
namespace {

NormalCone coneOf(const glm::dvec3& areaNormal) {
  const double length = glm::length(areaNormal);
  // A face without area faces nowhere; it can be a silhouette from anywhere.
  if (length == 0.0) return {};
  return {areaNormal / length, 1.0};
}

}  // namespace

BoundsGatherer::BoundsGatherer(const CollapseMesh& mesh, Placement placement)
    : placement_(placement),
      subtrees_(mesh.positions().size()),
      stars_(mesh.positions().size()) {
  for (std::uint32_t v = 0; v < subtrees_.size(); ++v) {
    std::optional<NormalCone> cone;
    const auto reach = [&](std::uint32_t a) {
      const double distance =
          glm::distance(glm::dvec3(mesh.positions()[v]), glm::dvec3(mesh.positions()[a]));
      stars_[v].radius = std::max(stars_[v].radius, static_cast<float>(distance));
    };
    mesh.forEachFace(v, [&](HalfEdgeId, std::uint32_t a, std::uint32_t b) {
      reach(a);
      reach(b);
      const NormalCone face = coneOf(mesh.areaNormal(v, a, b));
      cone = cone ? mergedCone(*cone, face) : face;
    });
    subtrees_[v].cone = stars_[v].cone = cone.value_or(NormalCone{});
  }
}

SplitBounds BoundsGatherer::beforeCollapse(
    const CollapseMesh& mesh,
    const HalfEdgeCollapse& collapse) {
  const std::uint32_t v = collapse.removed;
  const std::uint32_t u = collapse.kept;
  const auto at = [&](std::uint32_t x) { return glm::dvec3(mesh.positions()[x]); };
  const glm::dvec3 position = at(v);
  const glm::dvec3 kept(collapse.position);
  const bool moves = kept != at(u);

  NormalCone cone = subtrees_[v].cone;
  double radius = subtrees_[v].radius;
  if (placement_ == Placement::kVolume) {
    // What is around v now may stand elsewhere than in the full mesh.
    cone = mergedCone(cone, stars_[v].cone);
    radius = std::max(radius, static_cast<double>(stars_[v].radius));
  }
  double distance2 = glm::dot(kept - position, kept - position);
  // Where u moves: how far its old place is from the new faces, and its new one from the old faces.
  double oldDistance2 = glm::dot(kept - at(u), kept - at(u));
  double newDistance2 = std::min(oldDistance2, distance2);
  const auto closer = [](double& least, const glm::dvec3& p, const std::array<glm::dvec3, 3>& t) {
    const glm::dvec3 offset = closestPointOnTriangle(p, t[0], t[1], t[2]) - p;
    least = std::min(least, glm::dot(offset, offset));
  };
  const auto addFaces = [&](std::uint32_t centre, std::uint32_t other) {
    mesh.forEachFace(centre, [&](HalfEdgeId, std::uint32_t a, std::uint32_t b) {
      cone = mergedCone(cone, coneOf(mesh.areaNormal(centre, a, b)));
      radius = std::max({radius, glm::distance(position, at(a)), glm::distance(position, at(b))});
      if (moves) closer(newDistance2, kept, {at(centre), at(a), at(b)});
      if (a == other || b == other) return;
      cone = mergedCone(cone, coneOf(mesh.areaNormal(collapse.position, a, b)));
      closer(distance2, position, {kept, at(a), at(b)});
      if (moves) closer(oldDistance2, at(u), {kept, at(a), at(b)});
    });
  };
  addFaces(v, u);
  float error = 0.0F;
  if (moves) {
    addFaces(u, v);
    // While u stands elsewhere, no face around it is the full mesh's.
    const double moved = glm::distance(kept, at(u));
    cone = mergedCone(cone, stars_[u].cone);
    radius = std::max(
        {radius,
         glm::distance(position, kept),
         glm::distance(position, at(u)) + static_cast<double>(stars_[u].radius)});
    error = std::max(
        subtrees_[u].deviation + static_cast<float>(std::sqrt(oldDistance2)),
        std::max(subtrees_[u].deviation, subtrees_[v].deviation) +
            static_cast<float>(std::sqrt(newDistance2)));
    stars_[u].radius += static_cast<float>(moved);
    subtrees_[u].radius += static_cast<float>(moved);
  }

  // Rounding to floats must not leave a normal outside.
  constexpr double kRounding = 4e-7;
  const SplitBounds bounds{
      .center = glm::vec3(position),
      .radius = static_cast<float>(radius * (1.0 + 1e-6)),
      .error = std::max(error, subtrees_[v].deviation + static_cast<float>(std::sqrt(distance2))),
      .coneAxis = glm::vec3(cone.axis),
      .coneCos = static_cast<float>(std::max(-1.0, cone.cosHalf - kRounding))};

  Subtree& parent = subtrees_[u];
  parent.cone = mergedCone(parent.cone, cone);
  parent.radius =
      std::max(parent.radius, static_cast<float>(glm::distance(kept, position)) + bounds.radius);
  parent.deviation = std::max(parent.deviation, bounds.error);
  return bounds;
}

}  // namespace limn
