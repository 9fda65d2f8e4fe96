// SPDX-License-Identifier: Apache-2.0
#include "server/session/exact_set.h"

#include <utility>

namespace limn {

std::vector<std::uint8_t> facesOfExact(const FullMesh& full, const View& view) {
  const bool smooth = view.silhouette == protocol::Silhouette::kSmooth;
  const HalfEdgeMesh& mesh = full.mesh();
  const SilhouetteField& field =
      full.field(smooth ? SilhouetteKind::kSmooth : SilhouetteKind::kEdges);
  const glm::vec4 eye = field.eyeOf({view.eye, view.forward, view.orthographic});
  std::vector<std::uint8_t> front(field.siteCount());
  for (std::uint32_t site = 0; site < front.size(); ++site)
    front[site] = field.isFront(site, eye);
  std::vector<std::uint8_t> needed(mesh.faceCount(), 0);
  if (!smooth) {
    for (HalfEdgeId h = 0; h < mesh.twins.size(); ++h) {
      const HalfEdgeId twin = mesh.twins[h];
      if (twin == kNone) continue;
      if (front[HalfEdgeMesh::face(h)] != front[HalfEdgeMesh::face(twin)]) {
        needed[HalfEdgeMesh::face(h)] = 1;
      }
    }
    return needed;
  }
  const auto triangles = mesh.triangles();
  std::vector<std::uint8_t> corners(mesh.vertexCount(), 0);
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

TargetSet selectExact(const FullMesh& full, const View& view) {
  const SplitForest& forest = full.forest();
  const std::vector<std::uint8_t> needed = facesOfExact(full, view);
  std::vector<std::uint8_t> classes(forest.splitCount(), kNotNeeded);
  const std::uint32_t base = forest.baseVertexCount();
  const auto triangles = full.mesh().triangles();
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (needed[f] == 0) continue;
    forest.forEachSplitOfFace(triangles[f], [&](VertexId v) { classes[v - base] = 0; });
  }
  return targetSetOf(forest, closeOverPrerequisites(forest, std::move(classes)), 1);
}

}  // namespace limn
