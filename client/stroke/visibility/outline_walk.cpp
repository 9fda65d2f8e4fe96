// SPDX-License-Identifier: Apache-2.0
// Based on: O. Devillers, S. Pion, M. Teillaud, "Walking in a Triangulation", SoCG 2001: the
// visibility walk, here over the picture of a surface that nowhere turns from the eye.
#include "client/stroke/visibility/outline_walk.h"

namespace limn {
namespace {

/// Faces that a place is nearer to than this (grid units) are those it lies on.
constexpr double kOnSurface = 1e-4;

constexpr int kMostSteps = 24;

}  // namespace

OutlineWalk::OutlineWalk(const LineScene& scene) : mesh_(scene.mesh), faces_(scene) {}

OutlineWalk::Answer
OutlineWalk::covers(FaceId face, const glm::dvec3& place, FaceId own, FaceId ownOther) const {
  const glm::dvec3 way = faces_.towardEye(place);
  double turn = 0.0;  // which way round the eye sees the faces: of each the same
  for (int step = 0; step < kMostSteps; ++step) {
    const glm::dvec3 a = faces_.corner(3 * face) - place;
    const glm::dvec3 b = faces_.corner(3 * face + 1) - place;
    const glm::dvec3 c = faces_.corner(3 * face + 2) - place;
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double facing = glm::dot(n, way);
    if (facing == 0.0 || facing * turn < 0.0) return Answer::kUnknown;
    turn = facing < 0.0 ? -1.0 : 1.0;
    // On which side of each edge the line of view through the place passes.
    HalfEdgeId out = kNone;
    if (turn * glm::dot(way, glm::cross(a, b)) < 0.0) out = 3 * face;
    if (out == kNone && turn * glm::dot(way, glm::cross(b, c)) < 0.0) out = 3 * face + 1;
    if (out == kNone && turn * glm::dot(way, glm::cross(c, a)) < 0.0) out = 3 * face + 2;
    if (out == kNone) {
      if (face == own || face == ownOther) return Answer::kLiesBehind;
      const double ahead = glm::dot(n, a) / facing * glm::length(way);
      return ahead > kOnSurface ? Answer::kCovers : Answer::kLiesBehind;
    }
    const HalfEdgeId twin = mesh_.twin(out);
    if (twin == kNone) return Answer::kUnknown;
    face = HalfEdgeMesh::face(twin);
  }
  return Answer::kUnknown;
}

}  // namespace limn
