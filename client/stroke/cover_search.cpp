// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/cover_search.h"

#include "client/stroke/view_distance.h"

#include "shared/mesh/edge_shape.h"
#include "shared/mesh/fan.h"

#include <algorithm>

namespace limn {
namespace {

/// Faces that a place is nearer to than this (grid units) are those it lies on.
constexpr double kOnSurface = 1e-4;

}  // namespace

CoverSearch::CoverSearch(const LineScene& scene)
    : scene_(scene),
      eye_(scene.grid.fromModel(scene.camera.eye)),
      toEyeAtInfinity_(-scene.camera.forward()),
      ownSurface_(scene.mesh) {}

bool CoverSearch::isOwn(FaceId face, const Place& place) const {
  if (place.own == Own::kFace) return face == place.face || face == place.other;
  for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
    for (HalfEdgeId own = 3 * place.face; own < 3 * place.face + 3; ++own) {
      if (scene_.mesh.origin(h) == scene_.mesh.origin(own)) return true;
    }
  }
  return false;
}

// Whether the way from a place to the eye meets a face; its edges count.
bool CoverSearch::isBefore(FaceId face, const glm::dvec3& place, const glm::dvec3& way) const {
  const glm::dvec3 a = corner(3 * face) - place;
  const glm::dvec3 b = corner(3 * face + 1) - place;
  const glm::dvec3 c = corner(3 * face + 2) - place;
  const glm::dvec3 across = glm::cross(way, a);
  const double ab = glm::dot(across, b);
  const double ca = -glm::dot(across, c);
  if (ab * ca < 0.0) return false;
  const double bc = glm::dot(way, glm::cross(b, c));
  if (ab * bc < 0.0 || ca * bc < 0.0) return false;
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double facing = glm::dot(n, way);
  return facing != 0.0 && glm::dot(n, a) / facing * glm::length(way) > kOnSurface;
}

bool CoverSearch::covers(std::span<const FaceId> start, const Place& place) {
  const glm::dvec3 way = towardEye(place.at);
  tried_.assign(start.begin(), start.end());
  bool isFacetBefore = false;
  std::size_t next = 0;
  for (int ring = 0; ring <= kRings; ++ring) {
    for (const std::size_t end = tried_.size(); next < end; ++next) {
      const FaceId face = tried_[next];
      if (isBefore(face, place.at, way) && !isOwn(face, place)) {
        if (place.own == Own::kFace || !ownSurface_.has(place.face, face)) return true;
        isFacetBefore = true;
      }
      if (ring == kRings) continue;
      for (HalfEdgeId h = 3 * face; h < 3 * face + 3; ++h) {
        const HalfEdgeId twin = scene_.mesh.twin(h);
        if (twin == kNone) continue;
        const FaceId beside = HalfEdgeMesh::face(twin);
        if (std::find(tried_.begin(), tried_.end(), beside) == tried_.end())
          tried_.push_back(beside);
      }
    }
  }
  return isFacetBefore && isCoveredAside(place);
}

// Whether what was tried stands out so far that it covers the place moved outwards, too.
bool CoverSearch::isCoveredAside(const Place& place) const {
  const double distance =
      glm::dot(scene_.grid.toModel(place.at) - scene_.camera.eye, scene_.camera.forward());
  const double pixelsPerGrid =
      scene_.grid.step * pixelsPerUnit(scene_.camera, scene_.viewport, distance);
  const glm::dvec3 aside = place.at + OwnSurface::kReachPx / pixelsPerGrid * place.out;
  const glm::dvec3 way = towardEye(aside);
  return std::any_of(tried_.begin(), tried_.end(), [&](FaceId face) {
    return isBefore(face, aside, way) && !isOwn(face, place);
  });
}

CoverSearch::Place
CoverSearch::outside(FaceId face, const glm::dvec3& along, const glm::dvec3& place) const {
  Place moved{place, face, kNone, Own::kAround};
  glm::dvec3 out = glm::cross(along, towardEye(place));
  const double length = glm::length(out);
  if (!(length > 0.0)) return moved;
  const glm::dvec3 a = corner(3 * face) - place;
  const glm::dvec3 b = corner(3 * face + 1) - place;
  const glm::dvec3 c = corner(3 * face + 2) - place;
  out *= (glm::dot(out, glm::cross(b - a, c - a)) < 0.0 ? -1.0 : 1.0) / length;
  moved.at += std::max({0.0, glm::dot(a, out), glm::dot(b, out), glm::dot(c, out)}) * out;
  moved.out = out;
  return moved;
}

// The share of apex + s · along, s from 0 to 1, that the face of a corner at the apex covers: lines
// from there lie before or behind the face's plane all along, and leave the face once.
double CoverSearch::coveredBy(HalfEdgeId h, const glm::dvec3& apex, const glm::dvec3& along) const {
  if (!coversAtStart(scene_.mesh, scene_.positions, h, along, towardEye(apex))) return 0.0;
  const glm::dvec3 b = corner(HalfEdgeMesh::next(h)) - apex;
  const glm::dvec3 c = corner(HalfEdgeMesh::prev(h)) - apex;
  // Where the plane through the eye and the edge across meets the line.
  const glm::dvec3 across = glm::cross(c - b, towardEye(apex + b));
  const double share = glm::dot(across, b) / glm::dot(across, along);
  return share > 0.0 && share < 1.0 ? share : 1.0;
}

double CoverSearch::coveredShare(HalfEdgeId out, const glm::dvec3& to, FaceId own, FaceId ownOther)
    const {
  const glm::dvec3 apex = corner(out);
  double share = 0.0;
  forFan(scene_.mesh, out, [&](HalfEdgeId h) {
    const FaceId face = HalfEdgeMesh::face(h);
    if (face != own && face != ownOther) share = std::max(share, coveredBy(h, apex, to - apex));
  });
  return share;
}

}  // namespace limn
