// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   H. Hoppe, "Progressive meshes", SIGGRAPH 1996 (vertex splits);
//   H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (splits out of
//   order).
// Ours is the prerequisite rule (README.md): the parent and its canonical ring.
#include "shared/progressive/active_mesh.h"

#include <cstdlib>
#include <string>

namespace limn {
namespace {

tl::unexpected<Error> corrupt(VertexId vertex, const char* what) {
  return fail(ErrorCode::kCorrupt, "split of vertex " + std::to_string(vertex) + ": " + what);
}

}  // namespace

Result<ActiveMesh> ActiveMesh::fromBase(
    std::vector<std::uint32_t> levelBegin,
    const TriangleMesh& base,
    std::span<const std::uint8_t> features) {
  if (levelBegin.size() < 2 || levelBegin[0] != 0 || levelBegin[1] != base.positions.size() ||
      !std::is_sorted(levelBegin.begin(), levelBegin.end())) {
    return fail(ErrorCode::kCorrupt, "base mesh: vertex counts of the levels do not fit");
  }
  if (!features.empty() && features.size() != 3 * base.triangles.size()) {
    return fail(ErrorCode::kCorrupt, "base mesh: not one feature byte a half-edge");
  }
  if (!std::all_of(base.positions.begin(), base.positions.end(), isOnGrid)) {
    return fail(ErrorCode::kCorrupt, "base mesh: a position off the grid");
  }
  const AttributeArrays& attributes = base.attributes;
  const auto fits = [&](std::size_t size) { return size == 0 || size == levelBegin[1]; };
  if (!fits(attributes.colors.size()) || !fits(attributes.normals.size())) {
    return fail(ErrorCode::kCorrupt, "base mesh: not one colour or normal a vertex");
  }
  auto mesh = HalfEdgeMesh::build(levelBegin[1], base.triangles);
  if (!mesh) return tl::unexpected(mesh.error().within("base mesh"));

  ActiveMesh active;
  active.mesh_ = std::move(*mesh);
  active.positions_ = base.positions;
  active.attributes_ = attributes;
  active.ids_.resize(levelBegin[1]);
  for (std::uint32_t v = 0; v < levelBegin[1]; ++v) {
    active.ids_[v] = v;
    active.slots_.set(v, v);
  }
  active.parents_.assign(levelBegin[1], kNone);
  active.replaced_.assign(levelBegin[1], 0);
  active.features_.assign(features.begin(), features.end());
  active.features_.resize(active.mesh_.origins.size(), 0);
  active.levelBegin_ = std::move(levelBegin);
  return active;
}

Result<ActiveMesh::Opening> ActiveMesh::findOpening(const VertexSplit& split) {
  if (split.vertex < baseVertexCount() || split.vertex >= levelBegin_.back()) {
    return corrupt(split.vertex, "no such split in this model");
  }
  if (holds(split.vertex)) return corrupt(split.vertex, "already held");
  if (!holds(split.parent)) return corrupt(split.vertex, "its parent is not held");
  // Coarser neighbours only: this is also what ends the search for an ancestor.
  const VertexId levelBegin = levelBegin_[levelOf(split.vertex)];
  if (split.parent >= levelBegin) return corrupt(split.vertex, "its parent is not coarser");
  if (split.left == split.right) return corrupt(split.vertex, "its fan has no end");
  if (split.parentMove != glm::ivec3(0)) {
    const Slot parent = slotOf(split.parent);
    if (hasMoves() && lastMoves_[parent] != kNone && lastMoves_[parent] >= levelBegin) {
      return corrupt(split.vertex, "a finer one has moved its parent already");
    }
    const glm::i64vec3 moved = glm::i64vec3(positions_[parent]) + glm::i64vec3(split.parentMove);
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(moved[axis]) > kMaxGridCoordinate)
        return corrupt(split.vertex, "it moves its parent off the grid");
    }
  }
  for (const VertexId side : {split.left, split.right}) {
    if (side != kNone && !holds(side)) return corrupt(split.vertex, "a side vertex is not held");
  }
  const Slot u = slotOf(split.parent);
  const HalfEdgeId first = mesh_.outgoing[u];
  if (first == kNone) return corrupt(split.vertex, "its parent has no face");

  Opening opening;
  fan_.clear();
  const Slot r = split.right == kNone ? kNone : slotOf(split.right);
  HalfEdgeId h = first;
  if (split.left != kNone) {
    const Slot l = slotOf(split.left);
    h = mesh_.find(u, l);
    if (h != kNone) {
      opening.beforeLeft = mesh_.twin(h);
    } else {
      // l may be the far end of a border vertex's path, reached by a half-edge into u only.
      opening.beforeLeft = mesh_.find(l, u);
      if (opening.beforeLeft == kNone || mesh_.twin(opening.beforeLeft) != kNone) {
        return fail(ErrorCode::kNonManifold, "left vertex is not a neighbour of the parent");
      }
    }
  } else if (!mesh_.isBorderVertex(u)) {
    return fail(ErrorCode::kNonManifold, "a fan without left vertex at an interior parent");
  }
  while (h != kNone && (r == kNone || mesh_.target(h) != r)) {
    fan_.push_back(h);
    h = mesh_.rotateCcw(h);
    if (!fan_.empty() && h == fan_.front()) {
      return fail(ErrorCode::kNonManifold, "right vertex is not a neighbour of the parent");
    }
  }
  if (r == kNone) {
    if (!mesh_.isBorderVertex(u)) {
      return fail(ErrorCode::kNonManifold, "a fan without right vertex at an interior parent");
    }
  } else if (h != kNone) {
    opening.afterRight = h;
  } else if (fan_.empty() || mesh_.origin(mesh_.prev(fan_.back())) != r) {
    return fail(ErrorCode::kNonManifold, "right vertex is not a neighbour of the parent");
  }
  if (fan_.empty() && split.left != kNone && split.right != kNone) {
    return fail(ErrorCode::kNonManifold, "an empty fan at an interior parent");
  }
  return opening;
}

void ActiveMesh::setFeature(HalfEdgeId h, const VertexSplit& split, SplitFeature bit) {
  if (h == kNone) return;
  features_[h] = static_cast<std::uint8_t>(
      ((split.features & bit) != 0 ? kFeatureCrease : 0) |
      ((split.seams & bit) != 0 ? kFeatureSeam : 0));
}

void ActiveMesh::link(HalfEdgeId a, HalfEdgeId b) {
  if (a != kNone) mesh_.twins[a] = b;
  if (b != kNone) mesh_.twins[b] = a;
}

Result<void> ActiveMesh::apply(const VertexSplit& split) {
  const auto opening = findOpening(split);
  if (!opening) return tl::unexpected(opening.error());
  const auto& [beforeLeft, afterRight] = *opening;
  const std::vector<HalfEdgeId>& fan = fan_;
  const bool hasLeft = split.left != kNone;
  const bool hasRight = split.right != kNone;
  const Slot u = slotOf(split.parent);
  const auto v = static_cast<Slot>(ids_.size());
  const HalfEdgeId fanFirst = fan.empty() ? kNone : fan.front();  // v → l afterwards
  const HalfEdgeId fanLast =
      fan.empty() ? kNone : HalfEdgeMesh::prev(fan.back());  // r → v afterwards
  const bool outgoingMoves = std::find(fan.begin(), fan.end(), mesh_.outgoing[u]) != fan.end();

  const auto featureOf = [this](HalfEdgeId one, HalfEdgeId other) {
    const HalfEdgeId h = one != kNone ? one : other;
    return static_cast<std::uint8_t>(h == kNone ? 0 : features_[h] & 3);
  };
  const std::uint8_t oldLeft = hasLeft ? featureOf(beforeLeft, fanFirst) : std::uint8_t{0};
  const std::uint8_t oldRight = hasRight ? featureOf(afterRight, fanLast) : std::uint8_t{0};

  for (const HalfEdgeId h : fan)
    mesh_.origins[h] = v;

  // New faces (u, l, v) and (u, v, r); a missing side has none.
  const auto halfEdges = static_cast<HalfEdgeId>(mesh_.origins.size());
  const HalfEdgeId leftFace = hasLeft ? halfEdges : kNone;
  const HalfEdgeId rightFace = hasRight ? halfEdges + (hasLeft ? 3 : 0) : kNone;
  if (hasLeft) mesh_.origins.insert(mesh_.origins.end(), {u, slotOf(split.left), v});
  if (hasRight) mesh_.origins.insert(mesh_.origins.end(), {u, v, slotOf(split.right)});
  mesh_.twins.resize(mesh_.origins.size(), kNone);
  features_.resize(mesh_.origins.size(), 0);
  if (hasLeft) {
    link(leftFace, beforeLeft);
    link(leftFace + 1, fanFirst);
    setFeature(leftFace, split, kSplitEdgeUL);
    setFeature(beforeLeft, split, kSplitEdgeUL);
    setFeature(leftFace + 1, split, kSplitEdgeVL);
    setFeature(fanFirst, split, kSplitEdgeVL);
    setFeature(leftFace + 2, split, kSplitEdgeUV);
  }
  if (hasRight) {
    link(rightFace + 2, afterRight);
    link(rightFace + 1, fanLast);
    setFeature(rightFace + 2, split, kSplitEdgeUR);
    setFeature(afterRight, split, kSplitEdgeUR);
    setFeature(rightFace + 1, split, kSplitEdgeVR);
    setFeature(fanLast, split, kSplitEdgeVR);
    setFeature(rightFace, split, kSplitEdgeUV);
  }
  if (hasLeft && hasRight) link(leftFace + 2, rightFace);

  // A border vertex's outgoing half-edge is the one without a twin.
  if (!hasLeft) {
    mesh_.outgoing[u] = rightFace;
  } else if (outgoingMoves) {
    mesh_.outgoing[u] = leftFace;
  }
  if (hasLeft && fanFirst == kNone) mesh_.outgoing[slotOf(split.left)] = leftFace + 1;
  if (hasRight && afterRight == kNone) mesh_.outgoing[slotOf(split.right)] = rightFace + 2;
  if (hasLeft) {
    mesh_.outgoing.push_back(leftFace + 2);
  } else {
    mesh_.outgoing.push_back(fan.empty() ? rightFace + 1 : fanFirst);
  }

  positions_.push_back(split.position);
  if (!attributes_.colors.empty()) attributes_.colors.push_back(split.attributes.color);
  if (!attributes_.normals.empty()) attributes_.normals.push_back(split.attributes.normal);
  ids_.push_back(split.vertex);
  parents_.push_back(split.parent);
  replaced_.push_back(static_cast<std::uint8_t>(oldLeft | oldRight << 2));
  slots_.set(split.vertex, v);
  if (hasMoves() || split.parentMove != glm::ivec3(0)) moveParent(split, u);
  return {};
}

void ActiveMesh::moveParent(const VertexSplit& split, Slot u) {
  moves_.resize(ids_.size());
  lastMoves_.resize(ids_.size(), kNone);
  if (split.parentMove == glm::ivec3(0)) return;
  moves_.back() = {split.parentMove, lastMoves_[u]};
  lastMoves_[u] = split.vertex;
  positions_[u] += split.parentMove;
}

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

void ActiveMesh::reserve(std::uint32_t splits) {
  const std::size_t vertices = std::size_t{baseVertexCount()} + std::min(splits, splitsTotal());
  mesh_.origins.reserve(6 * vertices);
  mesh_.twins.reserve(6 * vertices);
  features_.reserve(6 * vertices);
  mesh_.outgoing.reserve(vertices);
  positions_.reserve(vertices);
  if (!attributes_.colors.empty()) attributes_.colors.reserve(vertices);
  if (!attributes_.normals.empty()) attributes_.normals.reserve(vertices);
  ids_.reserve(vertices);
  parents_.reserve(vertices);
  if (hasMoves()) {
    moves_.reserve(vertices);
    lastMoves_.reserve(vertices);
  }
  replaced_.reserve(vertices);
}

std::size_t ActiveMesh::bytes() const {
  return (mesh_.origins.capacity() + mesh_.twins.capacity() + mesh_.outgoing.capacity()) *
             sizeof(std::uint32_t) +
         positions_.capacity() * sizeof(glm::ivec3) +
         attributes_.colors.capacity() * sizeof(SrgbColor) +
         attributes_.normals.capacity() * sizeof(OctNormal) +
         (ids_.capacity() + parents_.capacity() + lastMoves_.capacity()) * sizeof(VertexId) +
         moves_.capacity() * sizeof(ParentMove) + features_.capacity() + replaced_.capacity() +
         slots_.bytes();
}

Result<void>
ActiveMesh::canonicalRing(VertexId parent, std::uint32_t level, std::vector<VertexId>& ring) const {
  if (!holds(parent)) {
    return fail(ErrorCode::kCorrupt, "split's parent " + std::to_string(parent) + " is not held");
  }
  canonicalRingSlots(slotOf(parent), level, ring);
  for (std::uint32_t& member : ring)
    member = ids_[member];
  return {};
}

void ActiveMesh::canonicalRingSlots(Slot u, std::uint32_t level, std::vector<Slot>& ring) const {
  const VertexId finerBegin = levelBegin_[level];
  ring.clear();
  const auto add = [&](Slot slot) {
    while (ids_[slot] >= finerBegin)
      slot = slots_[parents_[slot]];
    if (ring.empty() || ring.back() != slot) ring.push_back(slot);
  };
  const HalfEdgeId first = mesh_.outgoing[u];
  for (HalfEdgeId h = first; h != kNone;) {
    add(mesh_.target(h));
    const HalfEdgeId following = mesh_.rotateCcw(h);
    if (following == kNone) add(mesh_.origin(HalfEdgeMesh::prev(h)));
    h = following;
    if (h == first) break;
  }
  if (!mesh_.isBorderVertex(u)) {
    while (ring.size() > 1 && ring.front() == ring.back())
      ring.pop_back();
    // A cycle has no first vertex of its own: start at the smallest id.
    const auto size = static_cast<std::ptrdiff_t>(ring.size());
    std::ptrdiff_t least = 0;
    for (std::ptrdiff_t i = 1; i < size; ++i) {
      if (ids_[ring[static_cast<std::size_t>(i)]] < ids_[ring[static_cast<std::size_t>(least)]])
        least = i;
    }
    // Twice around, then a window: a few words, cheaper than std::rotate.
    ring.resize(2 * ring.size());
    std::copy_n(ring.begin(), size, ring.begin() + size);
    std::copy_n(ring.begin() + least, size, ring.begin());
    ring.resize(static_cast<std::size_t>(size));
  }
}

}  // namespace limn
