// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   H. Hoppe, "Progressive meshes", SIGGRAPH 1996 (vertex splits);
//   H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (splits out of
//   order).
// Ours is the prerequisite rule (README.md): the parent and its canonical ring.
#include "shared/progressive/active_mesh.h"

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
  auto mesh = HalfEdgeMesh::build(levelBegin[1], base.triangles);
  if (!mesh) return tl::unexpected(mesh.error().within("base mesh"));

  ActiveMesh active;
  active.mesh_ = std::move(*mesh);
  active.positions_ = base.positions;
  active.ids_.resize(levelBegin[1]);
  active.slots_.assign(levelBegin.back(), kNone);
  for (std::uint32_t v = 0; v < levelBegin[1]; ++v)
    active.ids_[v] = active.slots_[v] = v;
  active.parents_.assign(levelBegin[1], kNone);
  active.features_.assign(features.begin(), features.end());
  active.features_.resize(active.mesh_.origins.size(), 0);
  active.levelBegin_ = std::move(levelBegin);
  return active;
}

Result<ActiveMesh::Opening> ActiveMesh::findOpening(const VertexSplit& split) const {
  if (split.vertex < baseVertexCount() || split.vertex >= slots_.size()) {
    return corrupt(split.vertex, "no such split in this model");
  }
  if (holds(split.vertex)) return corrupt(split.vertex, "already held");
  if (!holds(split.parent)) return corrupt(split.vertex, "its parent is not held");
  // Coarser neighbours only: this is also what ends the search for an ancestor.
  const VertexId levelBegin = levelBegin_[levelOf(split.vertex)];
  if (split.parent >= levelBegin) return corrupt(split.vertex, "its parent is not coarser");
  if (split.left == split.right) return corrupt(split.vertex, "its fan has no end");
  for (const VertexId side : {split.left, split.right}) {
    if (side != kNone && !holds(side)) return corrupt(split.vertex, "a side vertex is not held");
  }
  const Slot u = slotOf(split.parent);
  const HalfEdgeId first = mesh_.outgoing[u];
  if (first == kNone) return corrupt(split.vertex, "its parent has no face");

  Opening opening;
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
    opening.fan.push_back(h);
    h = mesh_.rotateCcw(h);
    if (!opening.fan.empty() && h == opening.fan.front()) {
      return fail(ErrorCode::kNonManifold, "right vertex is not a neighbour of the parent");
    }
  }
  if (r == kNone) {
    if (!mesh_.isBorderVertex(u)) {
      return fail(ErrorCode::kNonManifold, "a fan without right vertex at an interior parent");
    }
  } else if (h != kNone) {
    opening.afterRight = h;
  } else if (opening.fan.empty() || mesh_.origin(mesh_.prev(opening.fan.back())) != r) {
    return fail(ErrorCode::kNonManifold, "right vertex is not a neighbour of the parent");
  }
  if (opening.fan.empty() && split.left != kNone && split.right != kNone) {
    return fail(ErrorCode::kNonManifold, "an empty fan at an interior parent");
  }
  return opening;
}

void ActiveMesh::setFeature(HalfEdgeId h, bool isFeature) {
  if (h != kNone) features_[h] = isFeature ? kFeatureCrease : 0;
}

Result<void> ActiveMesh::apply(const VertexSplit& split) {
  const auto opening = findOpening(split);
  if (!opening) return tl::unexpected(opening.error());
  const auto& [fan, beforeLeft, afterRight] = *opening;
  const bool hasLeft = split.left != kNone;
  const bool hasRight = split.right != kNone;
  const Slot u = slotOf(split.parent);
  const auto v = static_cast<Slot>(ids_.size());
  const HalfEdgeId fanFirst = fan.empty() ? kNone : fan.front();  // v → l afterwards
  const HalfEdgeId fanLast =
      fan.empty() ? kNone : HalfEdgeMesh::prev(fan.back());  // r → v afterwards
  const bool outgoingMoves = std::find(fan.begin(), fan.end(), mesh_.outgoing[u]) != fan.end();

  for (const HalfEdgeId h : fan)
    mesh_.origins[h] = v;

  // New faces (u, l, v) and (u, v, r); a missing side has none.
  const auto halfEdges = static_cast<HalfEdgeId>(mesh_.origins.size());
  const HalfEdgeId leftFace = hasLeft ? halfEdges : kNone;
  const HalfEdgeId rightFace = hasRight ? halfEdges + (hasLeft ? 3 : 0) : kNone;
  const auto link = [this](HalfEdgeId a, HalfEdgeId b) {
    if (a != kNone) mesh_.twins[a] = b;
    if (b != kNone) mesh_.twins[b] = a;
  };
  if (hasLeft) mesh_.origins.insert(mesh_.origins.end(), {u, slotOf(split.left), v});
  if (hasRight) mesh_.origins.insert(mesh_.origins.end(), {u, v, slotOf(split.right)});
  mesh_.twins.resize(mesh_.origins.size(), kNone);
  features_.resize(mesh_.origins.size(), 0);
  if (hasLeft) {
    link(leftFace, beforeLeft);
    link(leftFace + 1, fanFirst);
    setFeature(leftFace, split.features & kSplitEdgeUL);
    setFeature(beforeLeft, split.features & kSplitEdgeUL);
    setFeature(leftFace + 1, split.features & kSplitEdgeVL);
    setFeature(fanFirst, split.features & kSplitEdgeVL);
    setFeature(leftFace + 2, split.features & kSplitEdgeUV);
  }
  if (hasRight) {
    link(rightFace + 2, afterRight);
    link(rightFace + 1, fanLast);
    setFeature(rightFace + 2, split.features & kSplitEdgeUR);
    setFeature(afterRight, split.features & kSplitEdgeUR);
    setFeature(rightFace + 1, split.features & kSplitEdgeVR);
    setFeature(fanLast, split.features & kSplitEdgeVR);
    setFeature(rightFace, split.features & kSplitEdgeUV);
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
  ids_.push_back(split.vertex);
  parents_.push_back(split.parent);
  slots_[split.vertex] = v;
  return {};
}

Result<void>
ActiveMesh::canonicalRing(VertexId parent, std::uint32_t level, std::vector<VertexId>& ring) const {
  if (!holds(parent)) {
    return fail(ErrorCode::kCorrupt, "split's parent " + std::to_string(parent) + " is not held");
  }
  const VertexId finerBegin = levelBegin_[level];
  const Slot u = slotOf(parent);
  ring.clear();
  const auto add = [&](Slot slot) {
    VertexId id = ids_[slot];
    while (id >= finerBegin)
      id = parents_[slots_[id]];
    if (ring.empty() || ring.back() != id) ring.push_back(id);
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
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  }
  return {};
}

}  // namespace limn
