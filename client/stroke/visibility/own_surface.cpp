// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/visibility/own_surface.h"

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
  if (face != centre_) {
    near_.clear();
    nearBits_ = 0;
    anyAround(face, [&](std::uint32_t vertex) {
      near_.push_back(vertex);
      nearBits_ |= bitOf(vertex);
      return false;
    });
  }
  centre_ = face;
  return anyAround(other, [&](std::uint32_t vertex) {
    return (nearBits_ & bitOf(vertex)) != 0 &&
           std::find(near_.begin(), near_.end(), vertex) != near_.end();
  });
}

// Whether accept(vertex) of any of a face's corners and their neighbours; asks until one is.
template <class Accept>
bool OwnSurface::anyAround(FaceId face, Accept accept) const {
  for (HalfEdgeId first = 3 * face; first < 3 * face + 3; ++first) {
    if (accept(mesh_.origin(first))) return true;
  }
  bool isAny = false;
  for (HalfEdgeId first = 3 * face; !isAny && first < 3 * face + 3; ++first) {
    forFan(mesh_, first, [&](HalfEdgeId h) {
      isAny = isAny || accept(mesh_.target(h)) ||
              // The last of an open fan has one more neighbour.
              (mesh_.rotateCcw(h) == kNone && accept(mesh_.origin(HalfEdgeMesh::prev(h))));
    });
  }
  return isAny;
}

}  // namespace limn
