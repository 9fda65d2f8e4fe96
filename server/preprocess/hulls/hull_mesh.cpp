// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/hulls/hull_mesh.h"

#include "shared/core/assert.h"

#include <utility>

namespace limn {

HullMesh::HullMesh(HalfEdgeMesh mesh, std::vector<glm::ivec3> positions)
    : links_(std::move(mesh)),
      positions_(std::move(positions)),
      aliveFaces_(links_.faceCount()) {}

std::uint32_t HullMesh::valence(std::uint32_t v) const {
  std::uint32_t count = 0;
  const HalfEdgeId first = links_.outgoing[v];
  HalfEdgeId h = first;
  do {
    ++count;
    h = links_.rotateCcw(h);
  } while (h != first);
  return count;
}

bool HullMesh::canCollapse(HalfEdgeId h) const {
  const HalfEdgeId twin = links_.twin(h);
  const std::uint32_t a = links_.origin(h);
  const std::uint32_t b = links_.target(h);
  const std::uint32_t c = links_.origin(HalfEdgeMesh::prev(h));
  const std::uint32_t d = links_.origin(HalfEdgeMesh::prev(twin));
  // The corners lose an edge each.
  if (c == d || valence(c) < 4 || valence(d) < 4) return false;
  for (HalfEdgeId i = links_.rotateCcw(h); i != h; i = links_.rotateCcw(i)) {
    const std::uint32_t neighbour = links_.target(i);
    if (neighbour == c || neighbour == d) continue;
    for (HalfEdgeId j = links_.rotateCcw(twin); j != twin; j = links_.rotateCcw(j)) {
      if (links_.target(j) == neighbour) return false;
    }
  }
  return a != b;
}

HullMesh::Collapse HullMesh::collapse(HalfEdgeId h, const glm::ivec3& position) {
  const HalfEdgeId twin = links_.twin(h);
  const std::uint32_t a = links_.origin(h);
  const std::uint32_t b = links_.target(h);
  Collapse done;
  done.kept = a;
  done.removed = b;
  done.right = links_.origin(HalfEdgeMesh::prev(h));
  done.left = links_.origin(HalfEdgeMesh::prev(twin));
  done.keptPosition = positions_[a];
  done.removedPosition = positions_[b];

  for (HalfEdgeId i = links_.rotateCcw(twin); i != twin;) {
    const HalfEdgeId following = links_.rotateCcw(i);
    links_.origins[i] = a;
    i = following;
  }
  // Each dying face leaves its other two edges glued to one another.
  for (const HalfEdgeId dying : {h, twin}) {
    const HalfEdgeId one = links_.twin(HalfEdgeMesh::next(dying));
    const HalfEdgeId other = links_.twin(HalfEdgeMesh::prev(dying));
    links_.twins[one] = other;
    links_.twins[other] = one;
    links_.outgoing[links_.origin(one)] = one;
    links_.outgoing[links_.origin(other)] = other;
  }
  for (const HalfEdgeId dying : {h, twin}) {
    const FaceId f = HalfEdgeMesh::face(dying);
    for (std::uint32_t k = 0; k < 3; ++k) {
      links_.origins[3 * f + k] = kNone;
      links_.twins[3 * f + k] = kNone;
    }
  }
  links_.outgoing[b] = kNone;
  positions_[a] = position;
  aliveFaces_ -= 2;
  return done;
}

void HullMesh::facesAround(HalfEdgeId h, std::vector<FaceId>& out) const {
  out.clear();
  const HalfEdgeId twin = links_.twin(h);
  out.push_back(HalfEdgeMesh::face(h));
  out.push_back(HalfEdgeMesh::face(twin));
  // Around an end counter-clockwise, from the face after the edge's own to the one before the
  // other.
  for (HalfEdgeId i = links_.rotateCcw(h); i != HalfEdgeMesh::next(twin); i = links_.rotateCcw(i)) {
    out.push_back(HalfEdgeMesh::face(i));
  }
  for (HalfEdgeId i = links_.rotateCcw(twin); i != HalfEdgeMesh::next(h); i = links_.rotateCcw(i)) {
    out.push_back(HalfEdgeMesh::face(i));
  }
}

}  // namespace limn
