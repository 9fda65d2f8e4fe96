// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   H. Hoppe, "Progressive meshes", SIGGRAPH 1996 (vertex splits);
//   H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (splits out of
//   order).
// Ours is the prerequisite rule (README.md): the parent and its canonical ring.
#include "shared/progressive/active_mesh.h"

#include <algorithm>
#include <cstdlib>

namespace limn {

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

}  // namespace limn
