// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/cones.h"
#include "shared/silhouette/simd.h"

#include <bit>
#include <span>
#include <vector>

/// The two inner loops of ConesDetector, in a portable and an AVX2 version that give the same
/// silhouettes. Internal to shared/silhouette.
namespace limn::silhouette {

/// The eye, and the rounding that cone tests must allow for (ConeSlack).
struct Query {
  glm::vec4 eye;
  float slack = 0.0F;
};

/// What the test of a leaf found; bits are items.
struct LeafHits {
  std::uint64_t differing = 0;     // sites are not all alike
  std::uint64_t firstIsFront = 0;  // site [0] is front
};

/// Appends to `open` the children of the nodes `parents` of a level that may hold silhouettes.
void openChildrenPortable(
    std::span<const Node> level,
    std::span<const std::uint32_t> parents,
    const Query& query,
    std::vector<std::uint32_t>& open);

/// Tests the given leaves of a tree and appends to `result` what they hold.
void searchLeavesPortable(
    const ConeTree& tree,
    std::span<const std::uint32_t> leaves,
    const Query& query,
    SilhouetteResult& result);

#if LIMN_SILHOUETTE_AVX2
void openChildrenAvx2(
    std::span<const Node> level,
    std::span<const std::uint32_t> parents,
    const Query& query,
    std::vector<std::uint32_t>& open);
void searchLeavesAvx2(
    const ConeTree& tree,
    std::span<const std::uint32_t> leaves,
    const Query& query,
    SilhouetteResult& result);
#endif

inline void
appendChildren(std::uint32_t parent, std::uint32_t mask, std::vector<std::uint32_t>& open) {
  for (; mask != 0; mask &= mask - 1) {
    open.push_back(8 * parent + static_cast<std::uint32_t>(std::countr_zero(mask)));
  }
}

/// Appends the items that a leaf's hits name.
inline void
collect(const ConeTree& tree, const Leaf& leaf, const LeafHits& found, SilhouetteResult& result) {
  const bool isSmooth = result.kind == SilhouetteKind::kSmooth;
  result.stats.sitesTested += leaf.siteCount;
  result.stats.facesVisited += isSmooth ? leaf.itemCount : leaf.siteCount;
  std::vector<std::uint32_t>& out = isSmooth ? result.faces : result.edges;
  std::size_t next = out.size();
  out.resize(next + static_cast<std::size_t>(std::popcount(found.differing)));
  if (isSmooth) {
    const std::uint32_t* ids = tree.ids.data() + leaf.itemBegin;
    for (std::uint64_t hits = found.differing; hits != 0; hits &= hits - 1) {
      out[next++] = ids[std::countr_zero(hits)];
    }
  } else {
    const std::uint32_t* ids = tree.ids.data() + 2 * std::size_t{leaf.itemBegin};
    for (std::uint64_t hits = found.differing; hits != 0; hits &= hits - 1) {
      const int i = std::countr_zero(hits);
      const std::uint64_t isTwin = ~(found.firstIsFront >> i) & 1U;
      out[next++] = ids[2 * static_cast<std::size_t>(i) + isTwin];
    }
  }
}

/// Asks for the leaf that will be tested a few leaves on.
inline void
prefetchAhead(const ConeTree& tree, std::span<const std::uint32_t> leaves, std::size_t i) {
  constexpr std::size_t kAhead = 4;
  if (i + kAhead >= leaves.size()) return;
  const auto* next = reinterpret_cast<const char*>(&tree.leaves[leaves[i + kAhead]]);
  for (std::size_t line = 0; line < sizeof(Leaf); line += 64)
    __builtin_prefetch(next + line);
}

}  // namespace limn::silhouette
