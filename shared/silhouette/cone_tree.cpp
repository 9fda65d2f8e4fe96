// SPDX-License-Identifier: Apache-2.0
// Based on: P. V. Sander et al., "Silhouette Clipping", SIGGRAPH 2000, section 5: a forest of
// edge clusters with anchored cones.
// Deviations: clusters are grown and then put in order by median splits (milliseconds) instead of
// being joined greedily in pairs; eight children a node; all edges in leaves of a fixed layout,
// their planes in 16 bits.
#include "shared/silhouette/cone_tree.h"

#include "shared/silhouette/leaf_clusters.h"
#include "shared/view/anchored_pyramid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

namespace limn::silhouette {
namespace {

constexpr std::size_t kFanOut = 8;

std::int16_t toFixed(double value) {
  return static_cast<std::int16_t>(std::lrint(std::clamp(value, -1.0, 1.0) * kPlaneScale));
}

// Turns clusters into leaves.
template <class Leaf>
class LeafPacker {
 public:
  explicit LeafPacker(const ItemSource& source)
      : source_(&source),
        stamps_(source.siteCount(), 0),
        locals_(source.siteCount(), 0) {}

  /// The leaf's items and their sites; planes come once its centre is known.
  Leaf pack(std::span<const std::uint32_t> items, std::uint32_t itemBegin) {
    Leaf leaf{};
    leaf.itemBegin = itemBegin;
    leaf.itemCount = static_cast<std::uint8_t>(items.size());
    ++stamp_;
    sites_.clear();
    for (std::size_t i = 0; i < items.size(); ++i) {
      const std::array<std::uint32_t, 3> itemSites = source_->sitesOf(items[i]);
      const std::array<std::uint32_t, 3> places = source_->placesOf(items[i]);
      for (std::size_t k = 0; k < Leaf::kSitesPerItem; ++k) {
        const std::uint32_t site = itemSites[k];
        if (stamps_[site] != stamp_) {
          stamps_[site] = stamp_;
          locals_[site] = static_cast<std::uint8_t>(sites_.size());
          sites_.push_back(site);
        }
        leaf.sites[k][i] = static_cast<std::uint8_t>(locals_[site] | places[k] << 5);
      }
    }
    leaf.siteCount = static_cast<std::uint8_t>(sites_.size());
    return leaf;
  }

  /// The sites of the leaf packed last, by their local number.
  [[nodiscard]] std::span<const std::uint32_t> sites() const { return sites_; }

 private:
  const ItemSource* source_;
  std::vector<std::uint32_t> stamps_;  // by site: the last leaf that took it
  std::vector<std::uint8_t> locals_;   // by site: its place in that leaf
  std::vector<std::uint32_t> sites_;
  std::uint32_t stamp_ = 0;
};

// A float's upper half, rounded up.
std::uint16_t upperHalf(double positive) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(positive));
  return static_cast<std::uint16_t>((bits >> 16) + 1);
}

// Stores planes about `center`; unused slots repeat the first. Returns the leaf's radius
// (Node::radius).
template <class Leaf>
std::uint16_t storePlanes(std::span<const glm::vec4> planes, const glm::vec3& center, Leaf& leaf) {
  std::array<glm::dvec4, kLeafSites> unit{};
  double radius = 0.0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const glm::dvec3 n(planes[i]);
    const double length = glm::length(n);
    if (length == 0.0) continue;  // back, whatever the eye: always in doubt
    unit[i] = glm::dvec4(n, glm::dot(n, glm::dvec3(center)) + planes[i].w) / length;
    radius = std::max(radius, std::abs(unit[i].w));
  }
  const std::uint16_t stored = upperHalf(radius + 1e-6);
  const double bound = Node::radiusFrom(stored);
  for (std::size_t i = 0; i < kLeafSites; ++i) {
    const glm::dvec4& plane = unit[i < planes.size() ? i : 0];
    const std::size_t s = 2 * Leaf::slotOf(i);
    leaf.xy[s] = toFixed(plane.x);
    leaf.xy[s + 1] = toFixed(plane.y);
    leaf.zd[s] = toFixed(plane.z);
    leaf.zd[s + 1] = toFixed(plane.w / bound);
  }
  return stored;
}

void place(const AnchoredPyramid& pyramid, Node& node, std::size_t i) {
  node.centerX[i] = pyramid.center.x;
  node.centerY[i] = pyramid.center.y;
  node.centerZ[i] = pyramid.center.z;
  node.front[i] = pyramid.front;
  node.back[i] = pyramid.back;
  for (std::size_t k = 0; k < 3; ++k) {
    node.axis[k][i] = pyramid.axis[k];
    node.side1[k][i] = pyramid.side1[k];
    node.side2[k][i] = pyramid.side2[k];
  }
}

// Leaves and the pyramids of every level over them.
template <class Leaf>
class TreeBuilder {
 public:
  TreeBuilder(const ItemSource& source, const Clusters& clusters, double tangentScale)
      : source_(&source),
        clusters_(&clusters),
        tangentScale_(tangentScale) {}

  std::vector<Leaf> packLeaves(ConeTree& tree) {
    std::vector<Leaf> leaves;
    leaves.reserve(clusters_->clusters.size());
    LeafPacker<Leaf> packer(*source_);
    const auto items = std::span<const std::uint32_t>(clusters_->items);
    for (const Clusters::Cluster& c : clusters_->clusters) {
      leaves.push_back(packer.pack(items.subspan(c.begin, c.end - c.begin), c.begin));
      planeBegin_.push_back(planes_.size());
      for (const std::uint32_t site : packer.sites())
        planes_.push_back(source_->plane(site));
      radii_.push_back(storePlanes(
          std::span<const glm::vec4>(planes_).subspan(planeBegin_.back()),
          c.center,
          leaves.back()));
      if constexpr (Leaf::kSitesPerItem == 2) {
        const std::size_t begin = tree.siteFaces.size();
        for (const std::uint32_t site : packer.sites())
          tree.siteFaces.push_back(source_->siteIdOf(site));
        tree.siteFaces.resize(begin + kLeafSites, tree.siteFaces[begin]);
      }
    }
    planeBegin_.push_back(planes_.size());
    return leaves;
  }

  std::vector<std::vector<Node>> fitLevels() {
    std::vector<std::vector<Node>> levels;
    std::size_t children = clusters_->clusters.size();
    std::size_t leavesPerChild = 1;
    while (children > 0) {
      std::vector<Node> level((children + kFanOut - 1) / kFanOut, Node{});
      for (std::size_t c = 0; c < children; ++c)
        place(fit(c * leavesPerChild, leavesPerChild), level[c / kFanOut], c % kFanOut);
      if (levels.empty()) {
        for (std::size_t c = 0; c < children; ++c)
          level[c / kFanOut].radius[c % kFanOut] = radii_[c];
      }
      children = level.size();
      levels.push_back(std::move(level));
      if (children <= kFanOut) break;
      leavesPerChild *= kFanOut;
    }
    return levels;
  }

 private:
  AnchoredPyramid fit(std::size_t begin, std::size_t count) {
    const std::size_t end = std::min(begin + count, clusters_->clusters.size());
    glm::vec3 sum(0.0F);
    for (std::size_t l = begin; l < end; ++l)
      sum += clusters_->clusters[l].center;
    const auto planes = std::span<const glm::vec4>(planes_).subspan(
        planeBegin_[begin],
        planeBegin_[end] - planeBegin_[begin]);
    return fitAnchoredPyramid(planes, sum / static_cast<float>(end - begin), tangentScale_);
  }

  const ItemSource* source_;
  const Clusters* clusters_;
  double tangentScale_;
  std::vector<std::uint16_t> radii_;     // by leaf
  std::vector<glm::vec4> planes_;        // of every leaf, one after the other
  std::vector<std::size_t> planeBegin_;  // by leaf, and the end
};

template <class Leaf>
std::vector<Leaf> buildLeaves(const ItemSource& source, double tangentScale, ConeTree& tree) {
  const Clusters clusters = clusterItems(source, kLeafSites, Leaf::kMaxItems);
  TreeBuilder<Leaf> builder(source, clusters, tangentScale);
  if constexpr (Leaf::kSitesPerItem == 2) {
    tree.siteFaces.reserve(kLeafSites * clusters.clusters.size());
  } else {
    tree.faces.reserve(clusters.items.size());
    for (const std::uint32_t item : clusters.items)
      tree.faces.push_back(source.idOf(item));
  }
  auto leaves = builder.packLeaves(tree);
  tree.levels = builder.fitLevels();
  // |d|/|n| is the distance of a plane through a vertex, so at most the radius but for rounding.
  tree.extent = 1.001F * source.extent();
  return leaves;
}

}  // namespace

std::size_t ConeTree::memoryBytes() const {
  std::size_t bytes = edgeLeaves.capacity() * sizeof(EdgeLeaf) +
                      faceLeaves.capacity() * sizeof(FaceLeaf) +
                      (siteFaces.capacity() + faces.capacity()) * sizeof(FaceId);
  for (const auto& level : levels)
    bytes += level.capacity() * sizeof(Node);
  return bytes;
}

ConeTree
buildConeTree(const SilhouetteField& field, std::vector<std::uint32_t> items, double tangentScale) {
  ConeTree tree;
  tree.origin = field.center();
  tree.items = items.size();
  const ItemSource source(field, std::move(items));
  if (field.kind() == SilhouetteKind::kEdges) {
    tree.edgeLeaves = buildLeaves<EdgeLeaf>(source, tangentScale, tree);
  } else {
    tree.faceLeaves = buildLeaves<FaceLeaf>(source, tangentScale, tree);
  }
  return tree;
}

}  // namespace limn::silhouette
