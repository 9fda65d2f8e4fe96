// SPDX-License-Identifier: Apache-2.0
//
// Based on: H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (bounding
// spheres and normal cones of what a vertex stands for). The deviation is ours: the distance from
// each removed vertex to the surface that replaces it, added up along chains of collapses, so that
// it bounds the distance to the full mesh at the vertices.
#include "server/preprocess/forest/split_bounds.h"

#include "shared/mesh/closest_point.h"

#include <algorithm>
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

BoundsGatherer::BoundsGatherer(const CollapseMesh& mesh) : subtrees_(mesh.positions().size()) {
  for (std::uint32_t v = 0; v < subtrees_.size(); ++v) {
    std::optional<NormalCone> cone;
    mesh.forEachFace(v, [&](HalfEdgeId, std::uint32_t a, std::uint32_t b) {
      const NormalCone face = coneOf(mesh.areaNormal(v, a, b));
      cone = cone ? mergedCone(*cone, face) : face;
    });
    subtrees_[v].cone = cone.value_or(NormalCone{});
  }
}

SplitBounds BoundsGatherer::beforeCollapse(
    const CollapseMesh& mesh,
    const HalfEdgeCollapse& collapse) {
  const std::uint32_t v = collapse.removed;
  const std::uint32_t u = collapse.kept;
  const auto at = [&](std::uint32_t x) { return glm::dvec3(mesh.positions()[x]); };
  const glm::dvec3 position = at(v);

  NormalCone cone = subtrees_[v].cone;
  double radius = subtrees_[v].radius;
  double distance2 = glm::dot(at(u) - position, at(u) - position);
  mesh.forEachFace(v, [&](HalfEdgeId, std::uint32_t a, std::uint32_t b) {
    cone = mergedCone(cone, coneOf(mesh.areaNormal(v, a, b)));
    radius = std::max({radius, glm::distance(position, at(a)), glm::distance(position, at(b))});
    if (a == u || b == u) return;
    cone = mergedCone(cone, coneOf(mesh.areaNormal(u, a, b)));
    const glm::dvec3 offset = closestPointOnTriangle(position, at(u), at(a), at(b)) - position;
    distance2 = std::min(distance2, glm::dot(offset, offset));
  });

  // Rounding to floats must not leave a normal outside.
  constexpr double kRounding = 4e-7;
  const SplitBounds bounds{
      .center = glm::vec3(position),
      .radius = static_cast<float>(radius * (1.0 + 1e-6)),
      .error = subtrees_[v].deviation + static_cast<float>(std::sqrt(distance2)),
      .coneAxis = glm::vec3(cone.axis),
      .coneCos = static_cast<float>(std::max(-1.0, cone.cosHalf - kRounding))};

  Subtree& parent = subtrees_[u];
  parent.cone = mergedCone(parent.cone, cone);
  parent.radius =
      std::max(parent.radius, static_cast<float>(glm::distance(at(u), position)) + bounds.radius);
  parent.deviation = std::max(parent.deviation, bounds.error);
  return bounds;
}

}  // namespace limn
