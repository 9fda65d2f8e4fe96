// SPDX-License-Identifier: Apache-2.0
// Based on: P. V. Sander et al., "Silhouette Clipping", SIGGRAPH 2000, section 5: a forest of
// edge clusters with anchored cones.
// Deviations: clusters are grown and then put in order by median splits (milliseconds) instead of
// being joined greedily in pairs; eight children a node; all edges in leaves of a fixed layout.
#include "shared/silhouette/cones.h"
#include "shared/silhouette/leaf_clusters.h"
#include "shared/view/anchored_cone.h"

#include <algorithm>

namespace limn::silhouette {
namespace {

constexpr std::size_t kFanOut = 8;

// Turns clusters into leaves.
class LeafPacker {
 public:
  explicit LeafPacker(const ItemSource& source)
      : source_(&source),
        stamps_(source.siteCount(), 0),
        locals_(source.siteCount(), 0) {}

  Leaf pack(std::span<const std::uint32_t> items, std::uint32_t itemBegin) {
    Leaf leaf{};
    leaf.itemBegin = itemBegin;
    leaf.itemCount = static_cast<std::uint8_t>(items.size());
    ++stamp_;
    std::size_t sites = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const std::array<std::uint32_t, 3> itemSites = source_->sitesOf(items[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t site = itemSites[k];
        if (stamps_[site] != stamp_) {
          stamps_[site] = stamp_;
          locals_[site] = static_cast<std::uint8_t>(sites);
          store(leaf, sites++, source_->plane(site));
        }
        leaf.sites[k][i] = locals_[site];
      }
    }
    leaf.siteCount = static_cast<std::uint8_t>(sites);
    const glm::vec4 first = source_->plane(source_->sitesOf(items[0])[0]);
    for (std::size_t local = sites; local < kLeafSites; ++local)
      store(leaf, local, first);
    return leaf;
  }

 private:
  static void store(Leaf& leaf, std::size_t local, const glm::vec4& plane) {
    const std::size_t slot = Leaf::slotOf(local);
    leaf.x[slot] = plane.x;
    leaf.y[slot] = plane.y;
    leaf.z[slot] = plane.z;
    leaf.w[slot] = plane.w;
  }

  const ItemSource* source_;
  std::vector<std::uint32_t> stamps_;  // by site: the last leaf that took it
  std::vector<std::uint8_t> locals_;   // by site: its place in that leaf
  std::uint32_t stamp_ = 0;
};

// Fits the cones of every level over the leaves.
class ConeFitter {
 public:
  ConeFitter(std::span<const Clusters::Cluster> clusters, double tangentScale, ConeTree& tree)
      : clusters_(clusters),
        tangentScale_(tangentScale),
        tree_(&tree) {}

  void fit() {
    std::size_t children = tree_->leaves.size();
    std::size_t leavesPerChild = 1;
    while (children > 0) {
      const std::size_t nodes = (children + kFanOut - 1) / kFanOut;
      std::vector<Node> level(nodes, Node{});
      for (std::size_t c = 0; c < children; ++c) {
        const std::size_t begin = c * leavesPerChild;
        const std::size_t end = std::min(begin + leavesPerChild, tree_->leaves.size());
        place(fitLeaves(begin, end), level[c / kFanOut], c % kFanOut);
      }
      tree_->levels.push_back(std::move(level));
      if (nodes <= kFanOut) break;
      children = nodes;
      leavesPerChild *= kFanOut;
    }
  }

 private:
  AnchoredCone fitLeaves(std::size_t begin, std::size_t end) {
    planes_.clear();
    glm::vec3 sum(0.0F);
    for (std::size_t l = begin; l < end; ++l) {
      const Leaf& leaf = tree_->leaves[l];
      for (std::size_t i = 0; i < leaf.siteCount; ++i) {
        const std::size_t s = Leaf::slotOf(i);
        planes_.emplace_back(leaf.x[s], leaf.y[s], leaf.z[s], leaf.w[s]);
      }
      sum += clusters_[l].center;
    }
    return fitAnchoredCone(planes_, sum / static_cast<float>(end - begin), tangentScale_);
  }

  static void place(const AnchoredCone& cone, Node& node, std::size_t i) {
    node.centerX[i] = cone.center.x;
    node.centerY[i] = cone.center.y;
    node.centerZ[i] = cone.center.z;
    node.axisX[i] = cone.axis.x;
    node.axisY[i] = cone.axis.y;
    node.axisZ[i] = cone.axis.z;
    node.front[i] = cone.front;
    node.back[i] = cone.back;
    node.cotSquared[i] = cone.cotSquared;
    node.children |= 1U << i;
  }

  std::span<const Clusters::Cluster> clusters_;
  double tangentScale_;
  ConeTree* tree_;
  std::vector<glm::vec4> planes_;
};

}  // namespace

std::size_t ConeTree::memoryBytes() const {
  std::size_t bytes = leaves.capacity() * sizeof(Leaf) + ids.capacity() * sizeof(std::uint32_t);
  for (const auto& level : levels)
    bytes += level.capacity() * sizeof(Node);
  return bytes;
}

ConeTree buildConeTree(const SilhouetteField& field, double tangentScale) {
  const ItemSource source(field);
  Clusters clusters = clusterItems(source, kLeafSites, kLeafItems);
  ConeTree tree;
  tree.leaves.reserve(clusters.clusters.size());
  LeafPacker packer(source);
  for (const Clusters::Cluster& c : clusters.clusters) {
    const auto items = std::span<const std::uint32_t>(clusters.items);
    tree.leaves.push_back(packer.pack(items.subspan(c.begin, c.end - c.begin), c.begin));
  }
  ConeFitter(clusters.clusters, tangentScale, tree).fit();
  if (field.kind() == SilhouetteKind::kSmooth) {
    tree.ids = std::move(clusters.items);
  } else {
    tree.ids.reserve(2 * clusters.items.size());
    for (const HalfEdgeId h : clusters.items) {
      tree.ids.push_back(h);
      tree.ids.push_back(field.mesh().twins[h]);
    }
  }
  // |d|/|n| is the distance of a plane through a vertex, so at most the radius but for rounding.
  tree.extent = 1.001F * source.extent();
  return tree;
}

}  // namespace limn::silhouette
