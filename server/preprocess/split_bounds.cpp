// SPDX-License-Identifier: Apache-2.0
//
// Based on: H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (bounding
// spheres and normal cones of what a vertex stands for). The deviation is ours: the distance from
// each removed vertex to the surface that replaces it, added up along chains of collapses, so that
// it bounds the distance to the full mesh at the vertices.
#include "server/preprocess/split_bounds.h"

#include "shared/mesh/closest_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

struct Cone {
  glm::vec3 axis{0.0F};  // zero: empty
  float cos = 1.0F;
};

// The smallest cone around both, by their extreme directions; rounding is to the safe side.
Cone merged(const Cone& a, const Cone& b) {
  constexpr float kSlack = 1e-5F;
  if (a.axis == glm::vec3(0.0F)) return b;
  if (b.axis == glm::vec3(0.0F)) return a;
  const float between = std::acos(std::clamp(glm::dot(a.axis, b.axis), -1.0F, 1.0F));
  const float angleA = std::acos(std::clamp(a.cos, -1.0F, 1.0F));
  const float angleB = std::acos(std::clamp(b.cos, -1.0F, 1.0F));
  if (between + angleB <= angleA) return a;
  if (between + angleA <= angleB) return b;
  const float angle = 0.5F * (between + angleA + angleB) + kSlack;
  constexpr float kPi = 3.14159265F;
  if (angle >= kPi) return {a.axis, -1.0F};
  // Turn a's axis towards b's by what the cone grows beyond a's side.
  const glm::vec3 across = b.axis - glm::dot(a.axis, b.axis) * a.axis;
  const float length = glm::length(across);
  if (length < 1e-6F) return {a.axis, -1.0F};
  const float turn = angle - angleA;
  return {
      glm::normalize(std::cos(turn) * a.axis + std::sin(turn) * (across / length)),
      std::cos(angle)};
}

Cone ofNormal(const glm::dvec3& areaNormal) {
  const double length = glm::length(areaNormal);
  // A face without area faces nowhere; it can be a silhouette from anywhere.
  if (length == 0.0) return {glm::vec3(0.0F, 0.0F, 1.0F), -1.0F};
  return {glm::vec3(areaNormal / length), 1.0F};
}

template <class Visit>
void forEachFace(const CollapseMesh& mesh, std::uint32_t v, Visit visit) {
  const HalfEdgeMesh& halfEdges = mesh.mesh();
  const HalfEdgeId first = halfEdges.outgoing[v];
  for (HalfEdgeId h = first; h != kNone;) {
    visit(halfEdges.target(h), halfEdges.origin(HalfEdgeMesh::prev(h)));
    h = halfEdges.rotateCcw(h);
    if (h == first) break;
  }
}

}  // namespace

BoundsGatherer::BoundsGatherer(const CollapseMesh& mesh) : subtrees_(mesh.positions().size()) {
  for (std::uint32_t v = 0; v < subtrees_.size(); ++v) {
    Cone cone;
    forEachFace(mesh, v, [&](std::uint32_t a, std::uint32_t b) {
      cone = merged(cone, ofNormal(mesh.areaNormal(v, a, b)));
    });
    subtrees_[v].coneAxis = cone.axis;
    subtrees_[v].coneCos = cone.cos;
  }
}

SplitBounds BoundsGatherer::beforeCollapse(
    const CollapseMesh& mesh,
    const HalfEdgeCollapse& collapse) {
  const std::uint32_t v = collapse.removed;
  const std::uint32_t u = collapse.kept;
  const auto at = [&](std::uint32_t x) { return glm::dvec3(mesh.positions()[x]); };
  const glm::dvec3 position = at(v);

  Cone cone{subtrees_[v].coneAxis, subtrees_[v].coneCos};
  double radius = subtrees_[v].radius;
  double distance2 = glm::dot(at(u) - position, at(u) - position);
  forEachFace(mesh, v, [&](std::uint32_t a, std::uint32_t b) {
    cone = merged(cone, ofNormal(mesh.areaNormal(v, a, b)));
    radius = std::max({radius, glm::distance(position, at(a)), glm::distance(position, at(b))});
    if (a == u || b == u) return;
    cone = merged(cone, ofNormal(mesh.areaNormal(u, a, b)));
    const glm::dvec3 offset = closestPointOnTriangle(position, at(u), at(a), at(b)) - position;
    distance2 = std::min(distance2, glm::dot(offset, offset));
  });

  const SplitBounds bounds{
      .center = glm::vec3(position),
      .radius = static_cast<float>(radius * (1.0 + 1e-6)),
      .error = subtrees_[v].deviation + static_cast<float>(std::sqrt(distance2)),
      .coneAxis = cone.axis,
      .coneCos = cone.cos};

  Subtree& parent = subtrees_[u];
  const Cone both = merged({parent.coneAxis, parent.coneCos}, cone);
  parent.coneAxis = both.axis;
  parent.coneCos = both.cos;
  parent.radius =
      std::max(parent.radius, static_cast<float>(glm::distance(at(u), position)) + bounds.radius);
  parent.deviation = std::max(parent.deviation, bounds.error);
  return bounds;
}

}  // namespace limn
