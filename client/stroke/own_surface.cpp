// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/own_surface.h"

#include "shared/mesh/fan.h"

#include <algorithm>

namespace limn {

std::span<const FaceId> OwnSurface::around(FaceId face) {
  if (face == face_) return faces_;
  face_ = face;
  faces_.assign(1, face);
  const auto add = [&](HalfEdgeId h) {
    const FaceId beside = HalfEdgeMesh::face(h);
    if (std::find(faces_.begin(), faces_.end(), beside) == faces_.end()) faces_.push_back(beside);
  };
  std::size_t next = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    for (const std::size_t end = faces_.size(); next < end; ++next) {
      const HalfEdgeId begin = 3 * faces_[next];
      for (HalfEdgeId first = begin; first < begin + 3; ++first)
        forFan(mesh_, first, add);
    }
  }
  return faces_;
}

// Faces three corners apart have vertices with a neighbour in common.
bool OwnSurface::has(FaceId face, FaceId other) {
  static_assert(kRings == 3);
  if (face != centre_) gatherVertices(face, near_);
  centre_ = face;
  gatherVertices(other, beside_);
  return std::find_first_of(near_.begin(), near_.end(), beside_.begin(), beside_.end()) !=
         near_.end();
}

// Its corners and their neighbours.
void OwnSurface::gatherVertices(FaceId face, std::vector<std::uint32_t>& out) const {
  out.clear();
  for (HalfEdgeId first = 3 * face; first < 3 * face + 3; ++first) {
    out.push_back(mesh_.origin(first));
    forFan(mesh_, first, [&](HalfEdgeId h) {
      out.push_back(mesh_.target(h));
      // The last of an open fan has one more neighbour.
      if (mesh_.rotateCcw(h) == kNone) out.push_back(mesh_.origin(HalfEdgeMesh::prev(h)));
    });
  }
}

}  // namespace limn
