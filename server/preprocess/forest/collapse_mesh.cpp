// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/collapse_mesh.h"

#include "shared/progressive/vertex_split.h"

#include <algorithm>
#include <cmath>

namespace limn {
Result<CollapseMesh> CollapseMesh::build(
    const TriangleMesh& mesh,
    std::vector<std::uint8_t> features) {
  auto halfEdges =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  if (!halfEdges) return tl::unexpected(halfEdges.error());
  CollapseMesh result;
  result.mesh_ = std::move(*halfEdges);
  result.positions_ = mesh.positions;
  result.features_ = std::move(features);
  result.features_.resize(result.mesh_.origins.size(), 0);
  result.aliveFaces_ = result.mesh_.faceCount();
  return result;
}

glm::dvec3 CollapseMesh::areaNormal(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  const glm::dvec3 p(positions_[a]);
  return glm::cross(glm::dvec3(positions_[b]) - p, glm::dvec3(positions_[c]) - p);
}

glm::dvec3 CollapseMesh::areaNormal(const glm::ivec3& at, std::uint32_t b, std::uint32_t c) const {
  const glm::dvec3 p(at);
  return glm::cross(glm::dvec3(positions_[b]) - p, glm::dvec3(positions_[c]) - p);
}

bool CollapseMesh::turnsFace(
    std::uint32_t v,
    std::uint32_t u,
    const glm::ivec3& position,
    double leastNormalCosine) const {
  bool turns = false;
  forEachFace(v, [&](HalfEdgeId, std::uint32_t a, std::uint32_t b) {
    if (turns || a == u || b == u) return;
    const glm::dvec3 before = areaNormal(v, a, b);
    const glm::dvec3 after = areaNormal(position, a, b);
    const double lengths2 = glm::dot(before, before) * glm::dot(after, after);
    // A face that has no area already cannot get worse; one that would lose its area may not.
    turns = lengths2 > 0.0 ? glm::dot(before, after) < leastNormalCosine * std::sqrt(lengths2)
                           : glm::dot(before, before) > 0.0;
  });
  return turns;
}

std::optional<HalfEdgeCollapse> CollapseMesh::plan(
    std::uint32_t v,
    std::uint32_t u,
    const glm::ivec3& position,
    double leastNormalCosine) const {
  HalfEdgeCollapse result{.removed = v, .kept = u, .position = position};
  const HalfEdgeId vu = mesh_.find(v, u);
  const HalfEdgeId uv = vu != kNone ? mesh_.twin(vu) : mesh_.find(u, v);
  if (vu == kNone && uv == kNone) return std::nullopt;
  const bool borderEdge = vu == kNone || uv == kNone;
  // A border vertex may only move along the border, else the border would change its shape.
  if (mesh_.isBorderVertex(v) && !borderEdge) return std::nullopt;
  if (vu != kNone) result.left = mesh_.origin(HalfEdgeMesh::prev(vu));
  if (uv != kNone) result.right = mesh_.origin(HalfEdgeMesh::prev(uv));

  thread_local std::vector<std::uint32_t> ringV;
  thread_local std::vector<std::uint32_t> ringU;
  mesh_.ring(v, ringV);
  mesh_.ring(u, ringU);
  std::uint32_t common = 0;
  for (const std::uint32_t x : ringV) {
    if (std::find(ringU.begin(), ringU.end(), x) != ringU.end()) ++common;
  }
  const std::uint32_t sides = (result.left != kNone) + (result.right != kNone);
  if (common != sides) return std::nullopt;

  // What is left must still be a surface: three neighbours inside, two on a border.
  const auto wouldStarve = [&](std::uint32_t x, std::size_t neighbours) {
    return neighbours < (mesh_.isBorderVertex(x) ? 2U : 3U);
  };
  result.ringSize = ringU.size() + ringV.size() - 2 - common;
  if (wouldStarve(u, result.ringSize)) return std::nullopt;
  thread_local std::vector<std::uint32_t> ringSide;
  for (const std::uint32_t side : {result.left, result.right}) {
    if (side == kNone) continue;
    mesh_.ring(side, ringSide);
    if (wouldStarve(side, ringSide.size() - 1)) return std::nullopt;
  }
  if (turnsFace(v, u, position, leastNormalCosine)) return std::nullopt;
  if (position != positions_[u] && turnsFace(u, v, position, leastNormalCosine))
    return std::nullopt;

  const auto note = [&](HalfEdgeId h, SplitFeature bit) {
    if (h == kNone) return;
    if ((features_[h] & kFeatureCrease) != 0) result.features |= bit;
    if ((features_[h] & kFeatureSeam) != 0) result.seams |= bit;
  };
  note(vu, kSplitEdgeUV);
  note(uv, kSplitEdgeUV);
  if (vu != kNone) {
    note(HalfEdgeMesh::next(vu), kSplitEdgeUL);
    note(HalfEdgeMesh::prev(vu), kSplitEdgeVL);
  }
  if (uv != kNone) {
    note(HalfEdgeMesh::next(uv), kSplitEdgeVR);
    note(HalfEdgeMesh::prev(uv), kSplitEdgeUR);
  }
  return result;
}

// Rotates clockwise to the half-edge that invariant (5) of HalfEdgeMesh asks for.
void CollapseMesh::settleOutgoing(std::uint32_t v, HalfEdgeId any) {
  HalfEdgeId h = any;
  while (mesh_.twin(h) != kNone) {
    h = HalfEdgeMesh::next(mesh_.twin(h));
    if (h == any) break;
  }
  mesh_.outgoing[v] = h;
}

// The face of `inner` (an edge between removed and kept vertex) vanishes; its other two edges
// become one. Returns a half-edge of that edge.
HalfEdgeId CollapseMesh::removeFace(HalfEdgeId inner) {
  const HalfEdgeId one = HalfEdgeMesh::next(inner);
  const HalfEdgeId two = HalfEdgeMesh::prev(inner);
  const HalfEdgeId a = mesh_.twin(one);
  const HalfEdgeId b = mesh_.twin(two);
  const std::uint8_t feature = features_[one] | features_[two];
  for (const HalfEdgeId h : {a, b}) {
    if (h != kNone) features_[h] = feature;
  }
  if (a != kNone) mesh_.twins[a] = b;
  if (b != kNone) mesh_.twins[b] = a;
  for (const HalfEdgeId h : {inner, one, two})
    mesh_.origins[h] = mesh_.twins[h] = kNone;
  --aliveFaces_;
  return a != kNone ? a : b;
}

void CollapseMesh::collapse(const HalfEdgeCollapse& collapse) {
  const std::uint32_t v = collapse.removed;
  const std::uint32_t u = collapse.kept;
  const HalfEdgeId inner[2] = {mesh_.find(v, u), mesh_.find(u, v)};
  thread_local std::vector<HalfEdgeId> fan;
  fan.clear();
  const HalfEdgeId first = mesh_.outgoing[v];
  for (HalfEdgeId h = first; h != kNone;) {
    fan.push_back(h);
    h = mesh_.rotateCcw(h);
    if (h == first) break;
  }
  for (const HalfEdgeId h : fan)
    mesh_.origins[h] = u;
  mesh_.outgoing[v] = kNone;
  positions_[u] = collapse.position;

  HalfEdgeId merged[2] = {kNone, kNone};
  for (int i = 0; i < 2; ++i) {
    if (inner[i] != kNone) merged[i] = removeFace(inner[i]);
  }
  // Only now, with both faces gone, do rotations around u, l and r make sense again.
  for (const HalfEdgeId h : merged) {
    if (h == kNone) continue;
    for (const HalfEdgeId out : {h, HalfEdgeMesh::next(h)})
      settleOutgoing(mesh_.origin(out), out);
  }
}

void CollapseMesh::compact() {
  std::vector<FaceId> renumbered(mesh_.faceCount(), kNone);
  FaceId count = 0;
  for (FaceId f = 0; f < renumbered.size(); ++f) {
    if (isAlive(f)) renumbered[f] = count++;
  }
  const auto map = [&](HalfEdgeId h) { return h == kNone ? kNone : 3 * renumbered[h / 3] + h % 3; };
  for (FaceId f = 0; f < renumbered.size(); ++f) {
    if (renumbered[f] == kNone) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const HalfEdgeId from = 3 * f + k;
      const HalfEdgeId to = 3 * renumbered[f] + k;
      mesh_.origins[to] = mesh_.origins[from];
      mesh_.twins[to] = map(mesh_.twins[from]);
      features_[to] = features_[from];
    }
  }
  mesh_.origins.resize(3 * count);
  mesh_.twins.resize(3 * count);
  features_.resize(3 * count);
  for (HalfEdgeId& h : mesh_.outgoing)
    h = map(h);
}

}  // namespace limn
