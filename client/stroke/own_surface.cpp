// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/own_surface.h"

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
      for (HalfEdgeId first = begin; first < begin + 3; ++first) {
        HalfEdgeId h = mesh_.rotateCcw(first);
        for (; h != kNone && h != first; h = mesh_.rotateCcw(h))
          add(h);
        if (h != kNone) continue;
        for (h = mesh_.rotateCw(first); h != kNone; h = mesh_.rotateCw(h))
          add(h);
      }
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
    HalfEdgeId h = first;
    do {
      out.push_back(mesh_.target(h));
      h = mesh_.rotateCcw(h);
    } while (h != kNone && h != first);
    if (h != kNone) continue;
    // An open fan: its other half, and the last neighbour of this one.
    for (h = first; mesh_.rotateCcw(h) != kNone;)
      h = mesh_.rotateCcw(h);
    out.push_back(mesh_.origin(HalfEdgeMesh::prev(h)));
    for (h = mesh_.rotateCw(first); h != kNone; h = mesh_.rotateCw(h))
      out.push_back(mesh_.target(h));
  }
}

}  // namespace limn
