// SPDX-License-Identifier: Apache-2.0
#include "shared/progressive/active_mesh.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace limn {

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

tl::unexpected<Error> ActiveMesh::corrupt(VertexId vertex, const char* what) {
  return fail(ErrorCode::kCorrupt, "split of vertex " + std::to_string(vertex) + ": " + what);
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
