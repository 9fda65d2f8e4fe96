// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/visibility/cover_search.h"

#include "shared/mesh/edge_shape.h"
#include "shared/mesh/fan.h"

#include <algorithm>

namespace limn {
namespace {

/// Faces that a place is nearer to than this (grid units) are those it lies on.
constexpr double kOnSurface = 1e-4;

// Whether the way from a place to the eye meets a face; its edges count.
bool isBefore(const CoverSearch::Corners& corners, const glm::dvec3& place, const glm::dvec3& way) {
  const glm::dvec3 a = glm::dvec3(corners[0]) - place;
  const glm::dvec3 b = glm::dvec3(corners[1]) - place;
  const glm::dvec3 c = glm::dvec3(corners[2]) - place;
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

}  // namespace

CoverSearch::CoverSearch(const LineScene& scene)
    : scene_(scene),
      sceneFaces_(scene),
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

// Neighbouring places mostly have the same faces to start with.
void CoverSearch::begin(std::span<const FaceId> start) {
  if (std::equal(start.begin(), start.end(), start_.begin(), start_.end())) return;
  start_.assign(start.begin(), start.end());
  faces_ = start_;
  rings_ = 0;
}

// One more ring: first which faces it has, then where all their corners are, so that much of the
// mesh is waited for at once.
void CoverSearch::addRing() {
  const std::size_t done = rings_ > 0 ? ringEnd_[rings_ - 1] : 0;
  for (std::size_t i = rings_ > 1 ? ringEnd_[rings_ - 2] : 0; i < done; ++i) {
    for (HalfEdgeId h = 3 * faces_[i]; h < 3 * faces_[i] + 3; ++h) {
      const HalfEdgeId twin = scene_.mesh.twin(h);
      if (twin == kNone) continue;
      const FaceId beside = HalfEdgeMesh::face(twin);
      if (std::find(faces_.begin(), faces_.end(), beside) != faces_.end()) continue;
      faces_.push_back(beside);
      __builtin_prefetch(&scene_.mesh.origins[3 * beside]);
      __builtin_prefetch(&scene_.mesh.twins[3 * beside]);
    }
  }
  corners_.resize(faces_.size());
  for (std::size_t i = done; i < faces_.size(); ++i) {
    for (HalfEdgeId k = 0; k < 3; ++k)
      corners_[i][k] = scene_.positions[scene_.mesh.origin(3 * faces_[i] + k)];
  }
  ringEnd_[rings_++] = faces_.size();
}

bool CoverSearch::covers(std::span<const FaceId> start, const Place& place) {
  begin(start);
  const glm::dvec3 way = sceneFaces_.towardEye(place.at);
  bool isFacetBefore = false;
  std::size_t next = 0;
  for (std::size_t ring = 0; ring <= kRings; ++ring) {
    if (ring == rings_) addRing();
    for (; next < ringEnd_[ring]; ++next) {
      if (!isBefore(corners_[next], place.at, way) || isOwn(faces_[next], place)) continue;
      if (place.own == Own::kFace || !ownSurface_.has(place.face, faces_[next])) return true;
      isFacetBefore = true;
    }
  }
  return isFacetBefore && isCoveredAside(place);
}

// Whether what was tried stands out so far that it covers the place moved outwards, too.
bool CoverSearch::isCoveredAside(const Place& place) const {
  const double reach = OwnSurface::kReachPx / pixelsPerGrid(scene_, place.at);
  const glm::dvec3 aside = place.at + reach * place.out;
  const glm::dvec3 way = sceneFaces_.towardEye(aside);
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (isBefore(corners_[i], aside, way) && !isOwn(faces_[i], place)) return true;
  }
  return false;
}

CoverSearch::Place
CoverSearch::outside(FaceId face, const glm::dvec3& along, const glm::dvec3& place) const {
  Place moved{place, face, kNone, Own::kAround};
  moved.out = sceneFaces_.outward(face, along, place);
  moved.at += sceneFaces_.standOut(face, place, moved.out) * moved.out;
  return moved;
}

// The share of apex + s · along, s from 0 to 1, that the face of a corner at the apex covers: lines
// from there lie before or behind the face's plane all along, and leave the face once.
double CoverSearch::coveredBy(HalfEdgeId h, const glm::dvec3& apex, const glm::dvec3& along) const {
  if (!coversAtStart(scene_.mesh, scene_.positions, h, along, sceneFaces_.towardEye(apex)))
    return 0.0;
  const glm::dvec3 b = sceneFaces_.corner(HalfEdgeMesh::next(h)) - apex;
  const glm::dvec3 c = sceneFaces_.corner(HalfEdgeMesh::prev(h)) - apex;
  // Where the plane through the eye and the edge across meets the line.
  const glm::dvec3 across = glm::cross(c - b, sceneFaces_.towardEye(apex + b));
  const double share = glm::dot(across, b) / glm::dot(across, along);
  return share > 0.0 && share < 1.0 ? share : 1.0;
}

double CoverSearch::coveredShare(HalfEdgeId out, const glm::dvec3& to, FaceId own, FaceId ownOther)
    const {
  const glm::dvec3 apex = sceneFaces_.corner(out);
  double share = 0.0;
  forFan(scene_.mesh, out, [&](HalfEdgeId h) {
    const FaceId face = HalfEdgeMesh::face(h);
    if (face != own && face != ownOther) share = std::max(share, coveredBy(h, apex, to - apex));
  });
  return share;
}

}  // namespace limn
