// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   H. Hoppe, "Progressive meshes", SIGGRAPH 1996 (edge collapses);
//   T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, "Topology preserving edge contraction",
//   Publications de l'Institut Mathematique 66, 1999 (the link condition).
#include "shared/progressive/active_mesh.h"

#include <algorithm>
#include <utility>

namespace limn {

Result<ActiveMesh::Star> ActiveMesh::findStar(VertexId vertex) const {
  if (vertex < baseVertexCount() || vertex >= levelBegin_.back() || !holds(vertex)) {
    return corrupt(vertex, "cannot be undone, it is not held");
  }
  const Slot v = slotOf(vertex);
  const VertexId levelBegin = levelBegin_[levelOf(vertex)];
  Star star;
  star.u = slotOf(parents_[v]);
  if (hasMoves()) {
    const bool isLastMove = moves_[v].by == glm::ivec3(0) || lastMoves_[star.u] == vertex;
    if (!isLastMove || lastMoves_[v] != kNone)
      return corrupt(vertex, "cannot be undone, a finer one has moved it or its parent");
  }
  const bool isBorder = mesh_.isBorderVertex(v);
  std::vector<Slot> ring;
  const HalfEdgeId first = mesh_.outgoing[v];
  for (HalfEdgeId h = first; h != kNone;) {
    const HalfEdgeId into = HalfEdgeMesh::prev(h);
    ring.push_back(mesh_.target(h));
    if (mesh_.origin(into) == star.u) star.fromParent = into;
    if (mesh_.target(h) == star.u) star.toParent = h;
    h = mesh_.rotateCcw(h);
    if (h == kNone) ring.push_back(mesh_.origin(into));
    if (h == first) break;
  }
  for (const Slot neighbour : ring) {
    if (ids_[neighbour] >= levelBegin) {
      return corrupt(vertex, "cannot be undone, a finer one is built on it");
    }
  }
  const bool hasLeft = star.toParent != kNone;
  const bool hasRight = star.fromParent != kNone;
  if ((!hasLeft && !hasRight) || isBorder != (hasLeft != hasRight)) {
    return fail(ErrorCode::kNonManifold, "a vertex that lies no more where it was split off");
  }
  const HalfEdgeId inRight = hasRight ? HalfEdgeMesh::next(star.fromParent) : kNone;  // v → r
  for (HalfEdgeId h = first; h != kNone;) {
    if (h != star.toParent && h != inRight) star.fan.push_back(h);
    h = mesh_.rotateCcw(h);
    if (h == first) break;
  }
  // The link condition: u and v share l and r only.
  const Slot l = hasLeft ? mesh_.target(HalfEdgeMesh::next(star.toParent)) : kNone;
  const Slot r = hasRight ? mesh_.target(inRight) : kNone;
  std::vector<Slot> around;
  mesh_.ring(star.u, around);
  for (const Slot neighbour : ring) {
    if (neighbour == star.u || neighbour == l || neighbour == r) continue;
    if (std::find(around.begin(), around.end(), neighbour) != around.end()) {
      return fail(ErrorCode::kNonManifold, "a vertex whose collapse would fold the mesh");
    }
  }
  const bool staysByLeft =
      hasLeft && mesh_.twin(HalfEdgeMesh::next(star.toParent)) != kNone;  // l → u
  const bool staysByRight =
      hasRight && mesh_.twin(HalfEdgeMesh::prev(star.fromParent)) != kNone;  // u → r
  if (l == r || (star.fan.empty() && ((hasLeft && hasRight) || !(staysByLeft || staysByRight)))) {
    return fail(ErrorCode::kNonManifold, "a vertex whose collapse would leave no face");
  }
  return star;
}

void ActiveMesh::resetOutgoing(Slot slot, HalfEdgeId any) {
  HalfEdgeId h = any;
  while (mesh_.twin(h) != kNone) {
    h = mesh_.rotateCw(h);
    if (h == any) break;
  }
  mesh_.outgoing[slot] = h;
}

void ActiveMesh::removeFace(FaceId face) {
  const auto last = static_cast<FaceId>(mesh_.faceCount() - 1);
  if (face != last) {
    for (HalfEdgeId k = 0; k < 3; ++k) {
      const HalfEdgeId from = 3 * last + k;
      const HalfEdgeId to = 3 * face + k;
      mesh_.origins[to] = mesh_.origins[from];
      features_[to] = features_[from];
      mesh_.twins[to] = mesh_.twins[from];
      if (mesh_.twins[to] != kNone) mesh_.twins[mesh_.twins[to]] = to;
      HalfEdgeId& outgoing = mesh_.outgoing[mesh_.origins[to]];
      if (outgoing == from) outgoing = to;
    }
  }
  mesh_.origins.resize(3 * std::size_t{last});
  mesh_.twins.resize(3 * std::size_t{last});
  features_.resize(3 * std::size_t{last});
}

void ActiveMesh::removeVertex(Slot slot) {
  const auto last = static_cast<Slot>(ids_.size() - 1);
  slots_.set(ids_[slot], kNone);
  if (slot != last) {
    const HalfEdgeId first = mesh_.outgoing[last];
    for (HalfEdgeId h = first; h != kNone;) {
      mesh_.origins[h] = slot;
      h = mesh_.rotateCcw(h);
      if (h == first) break;
    }
    mesh_.outgoing[slot] = first;
    positions_[slot] = positions_[last];
    if (!attributes_.colors.empty()) attributes_.colors[slot] = attributes_.colors[last];
    if (!attributes_.normals.empty()) attributes_.normals[slot] = attributes_.normals[last];
    ids_[slot] = ids_[last];
    parents_[slot] = parents_[last];
    replaced_[slot] = replaced_[last];
    if (hasMoves()) {
      moves_[slot] = moves_[last];
      lastMoves_[slot] = lastMoves_[last];
    }
    slots_.set(ids_[slot], slot);
  }
  mesh_.outgoing.pop_back();
  positions_.pop_back();
  if (!attributes_.colors.empty()) attributes_.colors.pop_back();
  if (!attributes_.normals.empty()) attributes_.normals.pop_back();
  ids_.pop_back();
  parents_.pop_back();
  replaced_.pop_back();
  if (hasMoves()) {
    moves_.pop_back();
    lastMoves_.pop_back();
  }
}

Result<VertexSplit> ActiveMesh::undo(VertexId vertex) {
  const auto star = findStar(vertex);
  if (!star) return tl::unexpected(star.error());
  const Slot v = slotOf(vertex);
  const auto& [u, toParent, fromParent, fan] = *star;
  VertexSplit split;
  split.vertex = vertex;
  split.parent = parents_[v];
  split.position = positions_[v];
  split.attributes = attributes_.at(v);
  if (hasMoves() && moves_[v].by != glm::ivec3(0)) {
    split.parentMove = moves_[v].by;
    positions_[u] -= moves_[v].by;
    lastMoves_[u] = moves_[v].earlier;
  }
  const auto note = [&](HalfEdgeId h, SplitFeature bit) {
    if ((features_[h] & kFeatureCrease) != 0) split.features |= bit;
    if ((features_[h] & kFeatureSeam) != 0) split.seams |= bit;
  };
  const auto restore = [&](HalfEdgeId h, int feature) {
    if (h != kNone) features_[h] = static_cast<std::uint8_t>(feature);
  };

  for (const HalfEdgeId h : fan)
    mesh_.origins[h] = u;
  HalfEdgeId ofParent = fan.empty() ? kNone : fan.front();  // any half-edge out of u that stays
  if (toParent != kNone) {
    const HalfEdgeId toLeft = HalfEdgeMesh::next(toParent);    // u → l
    const HalfEdgeId fromLeft = HalfEdgeMesh::prev(toParent);  // l → v
    const Slot l = mesh_.origin(fromLeft);
    split.left = ids_[l];
    note(toParent, kSplitEdgeUV);
    note(toLeft, kSplitEdgeUL);
    note(fromLeft, kSplitEdgeVL);
    const HalfEdgeId beforeLeft = mesh_.twin(toLeft);
    const HalfEdgeId fanFirst = mesh_.twin(fromLeft);
    link(beforeLeft, fanFirst);
    restore(beforeLeft, replaced_[v] & 3);
    restore(fanFirst, replaced_[v] & 3);
    resetOutgoing(l, beforeLeft != kNone ? beforeLeft : HalfEdgeMesh::next(fanFirst));
    if (beforeLeft != kNone) ofParent = HalfEdgeMesh::next(beforeLeft);
  }
  if (fromParent != kNone) {
    const HalfEdgeId toRight = HalfEdgeMesh::next(fromParent);    // v → r
    const HalfEdgeId fromRight = HalfEdgeMesh::prev(fromParent);  // r → u
    const Slot r = mesh_.origin(fromRight);
    split.right = ids_[r];
    note(fromParent, kSplitEdgeUV);
    note(fromRight, kSplitEdgeUR);
    note(toRight, kSplitEdgeVR);
    const HalfEdgeId fanLast = mesh_.twin(toRight);
    const HalfEdgeId afterRight = mesh_.twin(fromRight);
    link(fanLast, afterRight);
    restore(fanLast, replaced_[v] >> 2);
    restore(afterRight, replaced_[v] >> 2);
    resetOutgoing(r, fanLast != kNone ? fanLast : HalfEdgeMesh::next(afterRight));
    if (afterRight != kNone) ofParent = afterRight;
  }
  resetOutgoing(u, ofParent);
  if (mesh_.isBorderVertex(u)) split.features |= kSplitParentOnBorder;

  // The later face first: the one that moves into its hole is then never the other.
  FaceId one = toParent == kNone ? kNone : HalfEdgeMesh::face(toParent);
  FaceId other = fromParent == kNone ? kNone : HalfEdgeMesh::face(fromParent);
  if (one == kNone || (other != kNone && other > one)) std::swap(one, other);
  removeFace(one);
  if (other != kNone) removeFace(other);
  removeVertex(v);
  return split;
}

}  // namespace limn
