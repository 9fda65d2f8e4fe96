// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/edge_shape.h"

#include "shared/mesh/fan.h"

#include <cmath>

namespace limn {

bool isCoveredNearby(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    HalfEdgeId h,
    const glm::dvec3& towardEye) {
  const glm::dvec3 p = edgeMiddle(mesh, positions, h);
  const HalfEdgeId twin = mesh.twin(h);
  const auto corner = [&](HalfEdgeId e) { return glm::dvec3(positions[mesh.origin(e)]); };
  const auto covers = [&](FaceId f) {
    const glm::dvec3 a = corner(3 * f);
    const glm::dvec3 ab = corner(3 * f + 1) - a;
    const glm::dvec3 ac = corner(3 * f + 2) - a;
    const glm::dvec3 q = glm::cross(towardEye, ac);
    const double det = glm::dot(ab, q);
    if (det == 0.0) return false;
    const double sign = det > 0.0 ? 1.0 : -1.0;
    const glm::dvec3 ap = p - a;
    const double u = sign * glm::dot(ap, q);
    if (u < 0.0 || u > std::abs(det)) return false;
    const glm::dvec3 r = glm::cross(ap, ab);
    const double v = sign * glm::dot(towardEye, r);
    return v >= 0.0 && u + v <= std::abs(det) && sign * glm::dot(ac, r) > 0.0;
  };
  for (const HalfEdgeId start : {h, twin}) {
    // Round the origin from this edge on; h's own face and its twin's come first and last.
    for (HalfEdgeId at = mesh.rotateCcw(start); at != kNone && at != start;
         at = mesh.rotateCcw(at)) {
      const FaceId f = HalfEdgeMesh::face(at);
      if (f != HalfEdgeMesh::face(h) && f != HalfEdgeMesh::face(twin) && covers(f)) return true;
    }
  }
  return false;
}

bool coversAtStart(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    HalfEdgeId h,
    const glm::dvec3& along,
    const glm::dvec3& towardEye) {
  const glm::dvec3 apex(positions[mesh.origin(h)]);
  const glm::dvec3 ab = glm::dvec3(positions[mesh.target(h)]) - apex;
  const glm::dvec3 ac = glm::dvec3(positions[mesh.origin(HalfEdgeMesh::prev(h))]) - apex;
  const glm::dvec3 q = glm::cross(towardEye, ac);
  const double det = glm::dot(ab, q);
  if (det == 0.0) return false;
  const double sign = det > 0.0 ? 1.0 : -1.0;
  if (sign * glm::dot(along, q) < 0.0) return false;
  const glm::dvec3 r = glm::cross(along, ab);
  return sign * glm::dot(towardEye, r) >= 0.0 && sign * glm::dot(ac, r) > 0.0;
}

bool isCoveredAtStart(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    HalfEdgeId out,
    HalfEdgeId edge,
    const glm::dvec3& along,
    const glm::dvec3& towardEye) {
  const FaceId own = HalfEdgeMesh::face(edge);
  const FaceId other = mesh.twin(edge) == kNone ? kNone : HalfEdgeMesh::face(mesh.twin(edge));
  bool isCovered = false;
  forFan(mesh, out, [&](HalfEdgeId h) {
    const FaceId face = HalfEdgeMesh::face(h);
    isCovered = isCovered || (face != own && face != other &&
                              coversAtStart(mesh, positions, h, along, towardEye));
  });
  return isCovered;
}

}  // namespace limn
