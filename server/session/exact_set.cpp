// SPDX-License-Identifier: Apache-2.0
#include "server/session/exact_set.h"

#include <algorithm>
#include <utility>

namespace limn {

Result<std::unique_ptr<const ExactFinder>> ExactFinder::make(const SplitForest& forest) {
  auto mesh = HalfEdgeMesh::build(forest.vertexCount(), forest.triangles);
  if (!mesh) return tl::unexpected(mesh.error());
  return std::unique_ptr<const ExactFinder>(new ExactFinder(forest, std::move(*mesh)));
}

ExactFinder::ExactFinder(const SplitForest& forest, HalfEdgeMesh mesh)
    : forest_(forest),
      mesh_(std::move(mesh)),
      edges_(mesh_, forest.positions, SilhouetteKind::kEdges),
      smooth_(mesh_, forest.positions, SilhouetteKind::kSmooth) {}

std::vector<std::uint8_t> ExactFinder::neededFaces(const View& view) const {
  const bool smooth = view.silhouette == protocol::Silhouette::kSmooth;
  const SilhouetteField& field = smooth ? smooth_ : edges_;
  const glm::vec4 eye = field.eyeOf({view.eye, view.forward, view.orthographic});
  std::vector<std::uint8_t> front(field.planes().size());
  for (std::uint32_t site = 0; site < front.size(); ++site)
    front[site] = field.isFront(site, eye);
  std::vector<std::uint8_t> needed(mesh_.faceCount(), 0);
  if (!smooth) {
    for (HalfEdgeId h = 0; h < mesh_.twins.size(); ++h) {
      const HalfEdgeId twin = mesh_.twins[h];
      if (twin == kNone) continue;
      if (front[HalfEdgeMesh::face(h)] != front[HalfEdgeMesh::face(twin)]) {
        needed[HalfEdgeMesh::face(h)] = 1;
      }
    }
    return needed;
  }
  const auto triangles = mesh_.triangles();
  std::vector<std::uint8_t> corners(mesh_.vertexCount(), 0);
  for (const glm::uvec3& t : triangles) {
    if (front[t.x] != front[t.y] || front[t.y] != front[t.z]) {
      corners[t.x] = corners[t.y] = corners[t.z] = 1;
    }
  }
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const glm::uvec3& t = triangles[f];
    needed[f] = corners[t.x] | corners[t.y] | corners[t.z];
  }
  return needed;
}

TargetSet ExactFinder::select(const View& view) const {
  const std::vector<std::uint8_t> needed = neededFaces(view);
  std::vector<std::uint8_t> classes(forest_.splitCount(), kNotNeeded);
  const std::uint32_t base = forest_.baseVertexCount();
  const auto triangles = mesh_.triangles();
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (needed[f] == 0) continue;
    const VertexId finest = std::max({triangles[f].x, triangles[f].y, triangles[f].z});
    if (finest >= base) classes[finest - base] = 0;
  }
  return targetSetOf(forest_, closeOverPrerequisites(forest_, std::move(classes)), 1);
}

std::size_t ExactFinder::bytes() const {
  return sizeof(*this) +
         4 * (mesh_.origins.capacity() + mesh_.twins.capacity() + mesh_.outgoing.capacity()) +
         sizeof(glm::vec4) * (edges_.planes().size() + smooth_.planes().size());
}

}  // namespace limn
