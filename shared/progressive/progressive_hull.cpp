// SPDX-License-Identifier: Apache-2.0
// Based on: P. Sander, X. Gu, S. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping", SIGGRAPH
// 2000.
#include "shared/progressive/progressive_hull.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

bool isHullPosition(const glm::ivec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < -kMaxHullCoordinate || p[axis] > kMaxHullCoordinate) return false;
  }
  return true;
}

}  // namespace

std::size_t ProgressiveHull::splitsFor(std::uint32_t faces) const {
  const std::size_t atBase = base.triangles.size();
  return faces <= atBase ? 0 : std::min(splits.size(), (faces - atBase) / 2);
}

Result<HullRefiner> HullRefiner::fromBase(const TriangleMesh& base) {
  auto links =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(base.positions.size()), base.triangles);
  if (!links) return tl::unexpected(links.error());
  if (std::find(links->twins.begin(), links->twins.end(), kNone) != links->twins.end() ||
      std::find(links->outgoing.begin(), links->outgoing.end(), kNone) != links->outgoing.end()) {
    return fail(ErrorCode::kNonManifold, "a hull's base mesh is not closed");
  }
  if (!std::all_of(base.positions.begin(), base.positions.end(), isHullPosition)) {
    return fail(ErrorCode::kCorrupt, "a position of a hull's base mesh is out of range");
  }
  HullRefiner result;
  result.grid_ = base.grid;
  result.links_ = std::move(*links);
  result.positions_ = base.positions;
  return result;
}

Result<void> HullRefiner::apply(const HullSplit& split) {
  const std::uint32_t u = split.vertex;
  const std::uint32_t added = links_.vertexCount();
  if (u >= added || split.left >= added || split.right >= added || split.left == split.right) {
    return fail(ErrorCode::kCorrupt, "a hull split names a vertex that is not there");
  }
  if (!isHullPosition(split.keptPosition) || !isHullPosition(split.addedPosition)) {
    return fail(ErrorCode::kCorrupt, "a hull split has a position out of range");
  }
  const HalfEdgeId toLeft = links_.find(u, split.left);
  const HalfEdgeId toRight = links_.find(u, split.right);
  if (toLeft == kNone || toRight == kNone) {
    return fail(ErrorCode::kNonManifold, "a hull split opens at vertices that are not neighbours");
  }
  // The fan's faces lie counter-clockwise of u → l up to u → r.
  for (HalfEdgeId h = toLeft; h != toRight; h = links_.rotateCcw(h)) {
    links_.origins[h] = added;
  }
  // Two faces open: (added, u, l) right of the fan's first edge, (u, added, r) left of its last.
  const HalfEdgeId first = static_cast<HalfEdgeId>(links_.origins.size());
  const HalfEdgeId second = first + 3;
  const HalfEdgeId leftOuter = links_.twin(toLeft);    // l → u, of the face before the fan
  const HalfEdgeId rightInner = links_.twin(toRight);  // r → u, of the fan's last face
  links_.origins.insert(links_.origins.end(), {added, u, split.left, u, added, split.right});
  links_.twins.insert(links_.twins.end(), {second, leftOuter, toLeft, first, rightInner, toRight});
  links_.twins[leftOuter] = first + 1;
  links_.twins[toLeft] = first + 2;
  links_.twins[rightInner] = second + 1;
  links_.twins[toRight] = second + 2;
  links_.outgoing[u] = second;
  links_.outgoing.push_back(first);
  positions_[u] = split.keptPosition;
  positions_.push_back(split.addedPosition);
  return {};
}

TriangleMesh HullRefiner::mesh() const {
  const auto triangles = links_.triangles();
  return {grid_, positions_, {triangles.begin(), triangles.end()}};
}

Result<TriangleMesh> hullAfter(const ProgressiveHull& hull, std::size_t count) {
  auto refiner = HullRefiner::fromBase(hull.base);
  if (!refiner) return tl::unexpected(refiner.error());
  for (std::size_t i = 0; i < std::min(count, hull.splits.size()); ++i) {
    if (auto applied = refiner->apply(hull.splits[i]); !applied) {
      return tl::unexpected(applied.error());
    }
  }
  return refiner->mesh();
}

double volume6(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]);
    sum +=
        glm::dot(a, glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z])));
  }
  return sum;
}

}  // namespace limn
