// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/hulls/crossing_guard.h"

namespace limn {

CrossingGuard::Face CrossingGuard::faceOf(const HullMesh& mesh, FaceId f) {
  Face face;
  for (std::uint32_t k = 0; k < 3; ++k) {
    face.corners[k] = mesh.links().origins[3 * f + k];
    face.triangle[k] = mesh.corner(f, k);
    face.box.add(face.triangle[k]);
  }
  return face;
}

bool CrossingGuard::wouldCross(const HullMesh& mesh, HalfEdgeId h, const glm::ivec3& position) {
  const std::uint32_t a = mesh.links().origin(h);
  const std::uint32_t b = mesh.links().target(h);
  mesh.facesAround(h, around_);
  faces_.clear();
  for (std::size_t i = 2; i < around_.size(); ++i) {
    Face face = faceOf(mesh, around_[i]);
    face.box = {};
    for (std::size_t k = 0; k < 3; ++k) {
      if (face.corners[k] == a || face.corners[k] == b) {
        face.corners[k] = a;
        face.triangle[k] = position;
      }
      face.box.add(face.triangle[k]);
    }
    faces_.push_back(face);
  }
  if (!meetAny(mesh, a, b)) return false;
  faces_.clear();
  for (const FaceId f : around_)
    faces_.push_back(faceOf(mesh, f));
  return !meetAny(mesh, a, b);
}

/// Whether any of faces_ meets another of them, or a face that has neither a nor b.
bool CrossingGuard::meetAny(const HullMesh& mesh, std::uint32_t a, std::uint32_t b) {
  const auto meet = [](const Face& s, const Face& t) {
    return s.box.meets(t.box) && hull::facesMeet(s.corners, s.triangle, t.corners, t.triangle);
  };
  GridBox all;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    all.add(faces_[i].box);
    for (std::size_t j = 0; j < i; ++j) {
      if (meet(faces_[i], faces_[j])) return true;
    }
  }
  tree_.find(all, found_);
  for (const FaceId f : found_) {
    if (!mesh.isAlive(f)) continue;
    const Face other = faceOf(mesh, f);
    bool isOurs = false;
    for (const std::uint32_t v : other.corners)
      isOurs = isOurs || v == a || v == b;
    if (isOurs) continue;
    for (const Face& face : faces_) {
      if (meet(face, other)) return true;
    }
  }
  return false;
}

void CrossingGuard::collapsed(const HullMesh& mesh, std::uint32_t kept) {
  const HalfEdgeMesh& links = mesh.links();
  const HalfEdgeId first = links.outgoing[kept];
  HalfEdgeId h = first;
  do {
    tree_.update(mesh, HalfEdgeMesh::face(h));
    h = links.rotateCcw(h);
  } while (h != first);
  tree_.maintain(mesh);
}

}  // namespace limn
