// SPDX-License-Identifier: Apache-2.0
// Based on: the logarithmic method of J. L. Bentley, J. B. Saxe, "Decomposable Searching Problems
// I", J. Algorithms 1(4), 1980 (a static structure made to change by keeping several, each twice
// the next), for the refitting of P. V. Sander et al., "Silhouette Clipping", SIGGRAPH 2000.
// Deviations: items also leave their trees, and take nothing with them: the cones stay.
#include "shared/silhouette/cone_forest.h"

#include "shared/core/assert.h"
#include "shared/silhouette/leaf_clusters.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

using silhouette::ConeTree;
using silhouette::EdgeLeaf;
using silhouette::FaceLeaf;
using silhouette::ItemSource;
using silhouette::kLeafSites;

// Which sites have another plane than before, or none any more; a bool each.
struct Changes {
  std::vector<std::uint8_t> faces;     // as many as the larger mesh has
  std::vector<std::uint8_t> vertices;  // kSmooth; so, too
};

Changes changesBetween(
    const HalfEdgeMesh& before,
    std::span<const glm::ivec3> positionsBefore,
    const SilhouetteField& after) {
  const HalfEdgeMesh& mesh = after.mesh();
  const std::span<const glm::ivec3> positions = after.positions();
  Changes changes;
  changes.vertices.assign(std::max(positionsBefore.size(), positions.size()), 1);
  for (std::size_t v = 0; v < std::min(positionsBefore.size(), positions.size()); ++v)
    changes.vertices[v] = positions[v] != positionsBefore[v] ? 1 : 0;
  const std::uint32_t common = std::min(before.faceCount(), mesh.faceCount());
  changes.faces.assign(std::max(before.faceCount(), mesh.faceCount()), 1);
  for (FaceId f = 0; f < common; ++f) {
    std::uint32_t changed = 0;
    for (HalfEdgeId h = 3 * f; h < 3 * f + 3; ++h) {
      changed |= mesh.origins[h] ^ before.origins[h];
      changed |= changes.vertices[mesh.origins[h]];
    }
    changes.faces[f] = changed != 0 ? 1 : 0;
  }
  if (after.kind() == SilhouetteKind::kEdges) return changes;
  // A vertex's plane is made of its faces.
  const auto markCorners = [&](const HalfEdgeMesh& of) {
    for (FaceId f = 0; f < of.faceCount(); ++f) {
      if (changes.faces[f] == 0) continue;
      for (HalfEdgeId h = 3 * f; h < 3 * f + 3; ++h)
        changes.vertices[of.origins[h]] = 1;
    }
  };
  markCorners(before);
  markCorners(mesh);
  return changes;
}

// Whether an item of the present mesh has a site that changed.
class Staleness {
 public:
  Staleness(const SilhouetteField& field, const Changes& changes)
      : mesh_(&field.mesh()),
        changes_(&changes) {}

  [[nodiscard]] bool ofFace(FaceId f) const {
    if (changes_->faces[f] != 0) return true;  // perhaps no face any more
    const std::uint32_t* corners = &mesh_->origins[3 * std::size_t{f}];
    const std::vector<std::uint8_t>& vertices = changes_->vertices;
    return (vertices[corners[0]] | vertices[corners[1]] | vertices[corners[2]]) != 0;
  }

  [[nodiscard]] bool ofEdge(FaceId a, FaceId b) const {
    return (changes_->faces[a] | changes_->faces[b]) != 0;
  }

 private:
  const HalfEdgeMesh* mesh_;
  const Changes* changes_;
};

// Takes stale items out of an edge leaf. An edge whose faces stayed is still between them.
void drop(const Staleness& stale, FaceId* siteFaces, EdgeLeaf& leaf) {
  const std::uint8_t had = leaf.itemCount;
  std::uint32_t used = 0;
  for (std::size_t i = 0; i < leaf.itemCount;) {
    const std::uint32_t a = leaf.sites[0][i] & 31U;
    const std::uint32_t b = leaf.sites[1][i] & 31U;
    if (!stale.ofEdge(siteFaces[a], siteFaces[b])) {
      used |= 1U << a | 1U << b;
      ++i;
      continue;
    }
    --leaf.itemCount;
    leaf.sites[0][i] = leaf.sites[0][leaf.itemCount];
    leaf.sites[1][i] = leaf.sites[1][leaf.itemCount];
  }
  if (leaf.itemCount == had) return;
  // Nobody asks for the sides of the other sites, but their faces may be gone.
  for (std::size_t s = 0; s < kLeafSites; ++s) {
    if ((used >> s & 1U) == 0) siteFaces[s] = 0;
  }
}

void drop(const Staleness& stale, FaceId* faces, FaceLeaf& leaf) {
  for (std::size_t i = 0; i < leaf.itemCount;) {
    if (!stale.ofFace(faces[leaf.itemBegin + i])) {
      ++i;
      continue;
    }
    --leaf.itemCount;
    faces[leaf.itemBegin + i] = faces[leaf.itemBegin + leaf.itemCount];
    for (auto& sites : leaf.sites)
      sites[i] = sites[leaf.itemCount];
  }
}

void drop(const Staleness& stale, ConeTree& tree) {
  tree.items = 0;
  for (std::size_t l = 0; l < tree.edgeLeaves.size(); ++l) {
    drop(stale, tree.siteFaces.data() + kLeafSites * l, tree.edgeLeaves[l]);
    tree.items += tree.edgeLeaves[l].itemCount;
  }
  for (FaceLeaf& leaf : tree.faceLeaves) {
    drop(stale, tree.faces.data(), leaf);
    tree.items += leaf.itemCount;
  }
}

// The ids of a tree's items.
void appendItems(const ConeTree& tree, const HalfEdgeMesh& mesh, std::vector<std::uint32_t>& ids) {
  for (std::size_t l = 0; l < tree.edgeLeaves.size(); ++l) {
    const EdgeLeaf& leaf = tree.edgeLeaves[l];
    for (std::size_t i = 0; i < leaf.itemCount; ++i) {
      const std::uint32_t side = leaf.sites[0][i];
      const HalfEdgeId h = 3 * tree.siteFaces[kLeafSites * l + (side & 31U)] + (side >> 5);
      ids.push_back(std::min(h, mesh.twins[h]));
    }
  }
  for (const FaceLeaf& leaf : tree.faceLeaves) {
    for (std::size_t i = 0; i < leaf.itemCount; ++i)
      ids.push_back(tree.faces[leaf.itemBegin + i]);
  }
}

std::vector<std::uint32_t> staleItems(const SilhouetteField& field, const Staleness& stale) {
  const HalfEdgeMesh& mesh = field.mesh();
  std::vector<std::uint32_t> ids;
  if (field.kind() == SilhouetteKind::kSmooth) {
    for (FaceId f = 0; f < mesh.faceCount(); ++f) {
      if (stale.ofFace(f)) ids.push_back(f);
    }
    return ids;
  }
  for (HalfEdgeId h = 0; h < mesh.twins.size(); ++h) {
    const HalfEdgeId twin = mesh.twins[h];
    if (twin != kNone && h < twin && stale.ofEdge(HalfEdgeMesh::face(h), HalfEdgeMesh::face(twin)))
      ids.push_back(h);
  }
  return ids;
}

}  // namespace

ConeForest::ConeForest(const SilhouetteField& field, double tangentScale)
    : kind_(field.kind()),
      tangentScale_(tangentScale) {
  trees_.push_back(silhouette::buildConeTree(field, ItemSource::allOf(field), tangentScale));
  const ConeTree& tree = trees_.front();
  if (tree.items > 0)
    leavesPerItem_ = static_cast<double>(tree.leafCount()) / static_cast<double>(tree.items);
}

void ConeForest::refit(
    const HalfEdgeMesh& before,
    std::span<const glm::ivec3> positionsBefore,
    const SilhouetteField& after) {
  LIMN_ASSERT(after.kind() == kind_);
  if (after.mesh().faceCount() == 0) {
    trees_.clear();
    return;
  }
  const Changes changes = changesBetween(before, positionsBefore, after);
  const Staleness stale(after, changes);
  for (ConeTree& tree : trees_)
    drop(stale, tree);
  std::vector<std::uint32_t> items = staleItems(after, stale);
  if (items.empty()) return;
  while (!trees_.empty() && trees_.back().items <= items.size()) {
    appendItems(trees_.back(), after.mesh(), items);
    trees_.pop_back();
  }
  std::sort(items.begin(), items.end());
  trees_.push_back(silhouette::buildConeTree(after, std::move(items), tangentScale_));
  if (trees_.size() == 1) {
    leavesPerItem_ =
        static_cast<double>(trees_.front().leafCount()) / static_cast<double>(trees_.front().items);
  }
}

double ConeForest::looseness() const {
  std::size_t leaves = 0;
  std::size_t items = 0;
  for (const ConeTree& tree : trees_) {
    leaves += tree.leafCount();
    items += tree.items;
  }
  if (items == 0 || leavesPerItem_ == 0.0) return leaves == 0 ? 1.0 : static_cast<double>(leaves);
  return static_cast<double>(leaves) / (leavesPerItem_ * static_cast<double>(items));
}

std::size_t ConeForest::memoryBytes() const {
  std::size_t bytes = 0;
  for (const ConeTree& tree : trees_)
    bytes += tree.memoryBytes();
  return bytes;
}

}  // namespace limn
