// SPDX-License-Identifier: Apache-2.0
// Based on: P. V. Sander et al., "Silhouette Clipping", SIGGRAPH 2000, section 5: a forest of
// edge clusters with anchored cones.
// Deviations: built top down by median splits in position and normal instead of bottom up by
// greedy joins (milliseconds instead of minutes); eight children a node; all edges in leaves of a
// fixed layout.
#include "shared/silhouette/cones.h"
#include "shared/view/anchored_cone.h"

#include <algorithm>
#include <cmath>

namespace limn::silhouette {
namespace {

constexpr std::size_t kFanOut = 8;
constexpr std::size_t kDimensions = 6;
// A leaf seldom fits more items into its sites; splits aim for multiples of it.
constexpr std::size_t kEdgesPerLeaf = 34;
constexpr std::size_t kFacesPerLeaf = 34;
// How far apart in units of the mesh's half diagonal two opposite normals count as being.
constexpr float kNormalWeight = 0.25F;

struct Item {
  std::array<float, kDimensions> at;  // position (relative to the mesh's size), weighted normal
  std::uint32_t id;
};

// What buildConeTree knows of a mesh: its items, and the sites of each.
class ItemSource {
 public:
  explicit ItemSource(const SilhouetteField& field) : field_(&field), mesh_(&field.mesh()) {}

  [[nodiscard]] std::size_t siteCountOfItem() const {
    return field_->kind() == SilhouetteKind::kEdges ? 2 : 3;
  }

  [[nodiscard]] std::size_t itemsPerLeaf() const {
    return field_->kind() == SilhouetteKind::kEdges ? kEdgesPerLeaf : kFacesPerLeaf;
  }

  // Sites of an item; an edge's third repeats its first.
  [[nodiscard]] std::array<std::uint32_t, 3> sitesOf(std::uint32_t id) const {
    if (field_->kind() == SilhouetteKind::kEdges) {
      const FaceId f = HalfEdgeMesh::face(id);
      return {f, HalfEdgeMesh::face(mesh_->twins[id]), f};
    }
    return {mesh_->origins[3 * id], mesh_->origins[3 * id + 1], mesh_->origins[3 * id + 2]};
  }

  [[nodiscard]] std::vector<Item> items() const {
    std::vector<Item> items;
    const float scale = 1.0F / std::max(extent(), 1.0F);
    const auto add = [&](std::uint32_t id, const glm::vec3& point) {
      const std::array<std::uint32_t, 3> sites = sitesOf(id);
      glm::vec3 normal(0.0F);
      for (std::size_t k = 0; k < siteCountOfItem(); ++k) {
        const glm::vec3 n(field_->planes()[sites[k]]);
        const float length = glm::length(n);
        if (length > 0.0F) normal += n / length;
      }
      const float length = glm::length(normal);
      if (length > 0.0F) normal *= kNormalWeight / length;
      const glm::vec3 p = point * scale;
      items.push_back({{p.x, p.y, p.z, normal.x, normal.y, normal.z}, id});
    };
    if (field_->kind() == SilhouetteKind::kEdges) {
      items.reserve(mesh_->origins.size() / 2);
      for (HalfEdgeId h = 0; h < mesh_->origins.size(); ++h) {
        if (mesh_->twins[h] == kNone || h > mesh_->twins[h]) continue;
        add(h, 0.5F * (pointOf(mesh_->origin(h)) + pointOf(mesh_->target(h))));
      }
    } else {
      items.reserve(mesh_->faceCount());
      for (FaceId f = 0; f < mesh_->faceCount(); ++f) {
        const glm::uvec3& t = mesh_->triangles()[f];
        add(f, (pointOf(t.x) + pointOf(t.y) + pointOf(t.z)) / 3.0F);
      }
    }
    return items;
  }

  // Largest distance of a vertex from the centre.
  [[nodiscard]] float extent() const {
    float square = 0.0F;
    for (std::uint32_t v = 0; v < mesh_->vertexCount(); ++v) {
      const glm::vec3 p = pointOf(v);
      square = std::max(square, glm::dot(p, p));
    }
    return std::sqrt(square);
  }

  [[nodiscard]] glm::vec4 plane(std::uint32_t site) const { return field_->planes()[site]; }

  [[nodiscard]] std::size_t siteCount() const { return field_->planes().size(); }

  [[nodiscard]] glm::vec3 pointOf(std::uint32_t v) const {
    return glm::vec3(field_->positions()[v] - field_->center());
  }

 private:
  const SilhouetteField* field_;
  const HalfEdgeMesh* mesh_;
};

// Splits items into leaves, in the order in which they will lie in memory.
class LeafBuilder {
 public:
  LeafBuilder(const ItemSource& source, ConeTree& tree)
      : source_(&source),
        tree_(&tree),
        items_(source.items()),
        stamps_(source.siteCount(), 0),
        locals_(source.siteCount(), 0) {
    tree.items.reserve(items_.size());
    tree.leaves.reserve(items_.size() / 24 + 1);
  }

  void build() {
    if (!items_.empty()) split(0, items_.size());
  }

  // Of each leaf, the sum of its items' positions, and in w their number.
  [[nodiscard]] const std::vector<glm::vec4>& centerSums() const { return centerSums_; }

 private:
  // Distinct sites of items [begin, end), at most kLeafSites + 1.
  std::size_t countSites(std::size_t begin, std::size_t end) {
    ++stamp_;
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      for (const std::uint32_t site : source_->sitesOf(items_[i].id)) {
        if (stamps_[site] == stamp_) continue;
        stamps_[site] = stamp_;
        if (++count > kLeafSites) return count;
      }
    }
    return count;
  }

  [[nodiscard]] std::size_t widestDimension(std::size_t begin, std::size_t end) const {
    std::array<float, kDimensions> low = items_[begin].at;
    std::array<float, kDimensions> high = low;
    for (std::size_t i = begin + 1; i < end; ++i) {
      for (std::size_t d = 0; d < kDimensions; ++d) {
        low[d] = std::min(low[d], items_[i].at[d]);
        high[d] = std::max(high[d], items_[i].at[d]);
      }
    }
    std::size_t widest = 0;
    for (std::size_t d = 1; d < kDimensions; ++d) {
      if (high[d] - low[d] > high[widest] - low[widest]) widest = d;
    }
    return widest;
  }

  void split(std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    if (count <= kLeafItems && countSites(begin, end) <= kLeafSites) {
      emit(begin, end);
      return;
    }
    const std::size_t perLeaf = source_->itemsPerLeaf();
    const std::size_t leaves = std::max<std::size_t>((count + perLeaf - 1) / perLeaf, 2);
    const std::size_t middle = begin + count * (leaves / 2) / leaves;
    const std::size_t d = widestDimension(begin, end);
    const auto at = [&](std::size_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [d](const Item& a, const Item& b) {
      return a.at[d] != b.at[d] ? a.at[d] < b.at[d] : a.id < b.id;
    });
    split(begin, middle);
    split(middle, end);
  }

  void emit(std::size_t begin, std::size_t end) {
    Leaf leaf{};
    leaf.itemBegin = static_cast<std::uint32_t>(tree_->items.size());
    leaf.itemCount = static_cast<std::uint8_t>(end - begin);
    ++stamp_;
    std::size_t sites = 0;
    glm::vec4 sum(0.0F);
    const auto store = [&](std::size_t local, const glm::vec4& plane) {
      const std::size_t slot = Leaf::slotOf(local);
      leaf.x[slot] = plane.x;
      leaf.y[slot] = plane.y;
      leaf.z[slot] = plane.z;
      leaf.w[slot] = plane.w;
    };
    for (std::size_t i = begin; i < end; ++i) {
      const std::array<std::uint32_t, 3> itemSites = source_->sitesOf(items_[i].id);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t site = itemSites[k];
        if (stamps_[site] != stamp_) {
          stamps_[site] = stamp_;
          locals_[site] = static_cast<std::uint8_t>(sites);
          store(sites++, source_->plane(site));
        }
        leaf.sites[k][i - begin] = locals_[site];
      }
      tree_->items.push_back(items_[i].id);
      sum += glm::vec4(items_[i].at[0], items_[i].at[1], items_[i].at[2], 1.0F);
    }
    leaf.siteCount = static_cast<std::uint8_t>(sites);
    centerSums_.push_back(sum);
    const glm::vec4 first = source_->plane(source_->sitesOf(items_[begin].id)[0]);
    for (std::size_t local = sites; local < kLeafSites; ++local)
      store(local, first);
    tree_->leaves.push_back(leaf);
  }

  const ItemSource* source_;
  ConeTree* tree_;
  std::vector<Item> items_;
  std::vector<std::uint32_t> stamps_;  // by site: the last cluster that counted it
  std::vector<std::uint8_t> locals_;   // by site: its place in that cluster's leaf
  std::vector<glm::vec4> centerSums_;
  std::uint32_t stamp_ = 0;
};

// Fits the cones of every level over the leaves.
class ConeFitter {
 public:
  // centerSums: see LeafBuilder, in units of `extent`.
  ConeFitter(
      std::span<const glm::vec4> centerSums,
      float extent,
      double tangentScale,
      ConeTree& tree)
      : centerSums_(centerSums),
        extent_(extent),
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
    for (std::size_t l = begin; l < end; ++l) {
      const Leaf& leaf = tree_->leaves[l];
      for (std::size_t i = 0; i < leaf.siteCount; ++i) {
        const std::size_t s = Leaf::slotOf(i);
        planes_.emplace_back(leaf.x[s], leaf.y[s], leaf.z[s], leaf.w[s]);
      }
    }
    return fitAnchoredCone(planes_, centerOf(begin, end), tangentScale_);
  }

  [[nodiscard]] glm::vec3 centerOf(std::size_t begin, std::size_t end) const {
    glm::vec4 sum(0.0F);
    for (std::size_t l = begin; l < end; ++l)
      sum += centerSums_[l];
    return glm::vec3(sum) * (extent_ / sum.w);
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

  std::span<const glm::vec4> centerSums_;
  float extent_;
  double tangentScale_;
  ConeTree* tree_;
  std::vector<glm::vec4> planes_;
};

}  // namespace

std::size_t ConeTree::memoryBytes() const {
  std::size_t bytes = leaves.capacity() * sizeof(Leaf) + items.capacity() * sizeof(std::uint32_t);
  for (const auto& level : levels)
    bytes += level.capacity() * sizeof(Node);
  return bytes;
}

ConeTree buildConeTree(const SilhouetteField& field, double tangentScale) {
  ConeTree tree;
  const ItemSource source(field);
  const float radius = source.extent();
  LeafBuilder builder(source, tree);
  builder.build();
  ConeFitter(builder.centerSums(), std::max(radius, 1.0F), tangentScale, tree).fit();
  // |d|/|n| is the distance of a plane through a vertex, so at most the radius but for rounding.
  tree.extent = 1.001F * radius;
  return tree;
}

}  // namespace limn::silhouette
