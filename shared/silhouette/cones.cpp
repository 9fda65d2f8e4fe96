// SPDX-License-Identifier: Apache-2.0
// Based on: P. V. Sander, X. Gu, S. J. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping",
// SIGGRAPH 2000, section 5 (search with anchored cones).
// Deviations: level by level instead of depth first, so that the next leaves can be fetched ahead;
// eight cones at a time; in a leaf all planes first, packed to a mask, then all edges (or faces) by
// table look-ups in that mask.
#include "shared/silhouette/cones.h"

#include "shared/silhouette/cones_search.h"
#include "shared/silhouette/simd.h"
#include "shared/view/anchored_cone.h"

#include <utility>

namespace limn {
namespace silhouette {

void openChildrenPortable(
    std::span<const Node> level,
    std::span<const std::uint32_t> parents,
    const Query& query,
    std::vector<std::uint32_t>& open) {
  const glm::vec4& eye = query.eye;
  for (const std::uint32_t n : parents) {
    const Node& node = level[n];
    std::uint32_t closed = 0;
    for (std::uint32_t i = 0; i < 8; ++i) {
      const float qx = eye.x - node.centerX[i] * eye.w;
      const float qy = eye.y - node.centerY[i] * eye.w;
      const float qz = eye.z - node.centerZ[i] * eye.w;
      const float along = qx * node.axisX[i] + qy * node.axisY[i] + qz * node.axisZ[i];
      const float square = qx * qx + qy * qy + qz * qz;
      const float across = (square - along * along) + ConeSlack::kSquare * square;
      const float inFront = (along - node.front[i] * eye.w) - query.slack;
      const float inBack = (along - node.back[i] * eye.w) + query.slack;
      const bool isFront = inFront > 0.0F && inFront * inFront * node.cotSquared[i] >= across;
      const bool isBack = inBack < 0.0F && inBack * inBack * node.cotSquared[i] >= across;
      closed |= static_cast<std::uint32_t>(isFront || isBack) << i;
    }
    appendChildren(n, node.children & ~closed, open);
  }
}

namespace {

LeafHits testLeaf(const Leaf& leaf, const glm::vec4& eye) {
  std::array<std::uint8_t, kLeafSites> front;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < kLeafSites; ++i) {
    const std::size_t s = Leaf::slotOf(i);
    const glm::vec4 plane(leaf.x[s], leaf.y[s], leaf.z[s], leaf.w[s]);
    front[i] = SilhouetteField::valueAt(plane, eye) > 0.0F ? 1 : 0;
    count += front[i];
  }
  LeafHits found;
  if (count == 0 || count == kLeafSites) return found;
  for (std::size_t i = 0; i < leaf.itemCount; ++i) {
    const std::uint64_t a = front[leaf.sites[0][i]];
    const std::uint64_t b = front[leaf.sites[1][i]];
    const std::uint64_t c = front[leaf.sites[2][i]];
    found.differing |= ((a ^ b) | (a ^ c)) << i;
    found.firstIsFront |= a << i;
  }
  return found;
}

}  // namespace

void searchLeavesPortable(
    const ConeTree& tree,
    std::span<const std::uint32_t> leaves,
    const Query& query,
    SilhouetteResult& result) {
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    prefetchAhead(tree, leaves, i);
    const Leaf& leaf = tree.leaves[leaves[i]];
    collect(tree, leaf, testLeaf(leaf, query.eye), result);
  }
}

}  // namespace silhouette

ConesDetector::ConesDetector(const SilhouetteField& field, const DetectorOptions& options)
    : field_(&field),
      useAvx2_(options.vectorized && silhouette::hasAvx2()),
      tree_(silhouette::buildConeTree(field, options.coneTangentScale)) {}

const SilhouetteResult& ConesDetector::detect(const SilhouetteView& view) {
  result_.kind = field_->kind();
  result_.edges.clear();
  result_.faces.clear();
  result_.stats = {};
  silhouette::Query query;
  query.eye = field_->eyeOf(view);
  query.slack =
      ConeSlack::kDistance * (glm::length(glm::vec3(query.eye)) + tree_.extent * query.eye.w);

  auto openChildren = silhouette::openChildrenPortable;
  auto searchLeaves = silhouette::searchLeavesPortable;
#if LIMN_SILHOUETTE_AVX2
  if (useAvx2_) {
    openChildren = silhouette::openChildrenAvx2;
    searchLeaves = silhouette::searchLeavesAvx2;
  }
#endif
  frontier_.clear();
  if (!tree_.levels.empty()) {
    for (std::uint32_t n = 0; n < tree_.levels.back().size(); ++n)
      frontier_.push_back(n);
  }
  for (std::size_t l = tree_.levels.size(); l-- > 0;) {
    result_.stats.clustersTested += static_cast<std::uint32_t>(8 * frontier_.size());
    below_.clear();
    openChildren(tree_.levels[l], frontier_, query, below_);
    std::swap(frontier_, below_);
  }
  searchLeaves(tree_, frontier_, query, result_);
  result_.stats.segments = static_cast<std::uint32_t>(result_.edges.size() + result_.faces.size());
  return result_;
}

std::size_t ConesDetector::memoryBytes() const {
  return tree_.memoryBytes() + (frontier_.capacity() + below_.capacity() +
                                result_.edges.capacity() + result_.faces.capacity()) *
                                   sizeof(std::uint32_t);
}

}  // namespace limn
