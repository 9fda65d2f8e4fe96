// SPDX-License-Identifier: Apache-2.0
#include "server/session/full_mesh.h"

#include <utility>

namespace limn {

Result<std::unique_ptr<const FullMesh>> FullMesh::make(const SplitForest& forest) {
  auto mesh = HalfEdgeMesh::build(forest.vertexCount(), forest.triangles);
  if (!mesh) return tl::unexpected(mesh.error());
  return std::unique_ptr<const FullMesh>(new FullMesh(forest, std::move(*mesh)));
}

FullMesh::FullMesh(const SplitForest& forest, HalfEdgeMesh mesh)
    : forest_(forest),
      mesh_(std::move(mesh)),
      edges_(mesh_, forest.positions, SilhouetteKind::kEdges),
      smooth_(mesh_, forest.positions, SilhouetteKind::kSmooth),
      childrenBegin_(std::size_t{forest.vertexCount()} + 1, 0),
      children_(forest.splitCount()) {
  for (const VertexId parent : forest.parents)
    ++childrenBegin_[parent + 1];
  for (std::size_t v = 1; v < childrenBegin_.size(); ++v)
    childrenBegin_[v] += childrenBegin_[v - 1];
  std::vector<std::uint32_t> next(childrenBegin_.begin(), childrenBegin_.end() - 1);
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v)
    children_[next[forest.parent(v)]++] = v;
}

std::size_t FullMesh::bytes() const {
  return sizeof(*this) +
         4 * (mesh_.origins.capacity() + mesh_.twins.capacity() + mesh_.outgoing.capacity() +
              childrenBegin_.capacity() + children_.capacity()) +
         edges_.memoryBytes() + smooth_.memoryBytes();
}

}  // namespace limn
