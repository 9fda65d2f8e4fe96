// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/simd.h"
#include "shared/silhouette/cones.h"

#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

/// The inner loops of ConesDetector, in portable, AVX2 and AVX-512 versions that find the same
/// silhouettes. Internal to shared/silhouette.
namespace limn::silhouette {

/// The eye, and the rounding that pyramids' tests must allow for (PyramidSlack, times kScale).
struct Query {
  const SilhouetteField* field = nullptr;
  const ConeTree* tree = nullptr;
  glm::vec4 eye;       // about the tree's origin
  glm::vec4 fieldEye;  // the field's
  float slack = 0.0F;
};

/// What the test of a leaf found; bits are items.
struct LeafHits {
  std::uint64_t differing;     // sites are not all alike
  std::uint64_t firstIsFront;  // site [0] is front
};

/// A leaf that held silhouettes.
inline constexpr std::uint8_t kHit = 0xFF;

/// Where open leaves go: those that held silhouettes in the last frame apart.
struct LeafLists {
  std::span<const std::uint8_t> lastHits;  // by leaf, kHit or 0; empty: none
  OpenLeaves* firsts = nullptr;            // may be null where lastHits is empty
  OpenLeaves* others = nullptr;
};

/// Appends to `open` the children of the nodes `parents` of a level that may hold silhouettes.
void openChildrenPortable(
    const Query& query,
    std::size_t level,
    std::span<const std::uint32_t> parents,
    OpenNodes& open);

/// The same for the lowest level.
void openLeavesPortable(
    const Query& query,
    std::span<const std::uint32_t> parents,
    const LeafLists& lists);

/// Tests leaves and appends to `result` what they hold; in `hits` (by leaf; may be empty) it marks
/// those that hold any.
void searchLeavesPortable(
    const Query& query,
    const OpenLeaves& leaves,
    SilhouetteResult& result,
    std::span<std::uint8_t> hits);

#if LIMN_HAS_AVX2
void openChildrenAvx2(
    const Query& query,
    std::size_t level,
    std::span<const std::uint32_t> parents,
    OpenNodes& open);
void openLeavesAvx2(
    const Query& query,
    std::span<const std::uint32_t> parents,
    const LeafLists& lists);
void searchLeavesAvx2(
    const Query& query,
    const OpenLeaves& leaves,
    SilhouetteResult& result,
    std::span<std::uint8_t> hits);
void searchLeavesAvx512(
    const Query& query,
    const OpenLeaves& leaves,
    SilhouetteResult& result,
    std::span<std::uint8_t> hits);
#endif

/// The slack's share that is the field's own rounding, 4.01 u (|eye| + extent), and some more: it
/// has 64 u (PyramidSlack). Times kPlaneScale: the slack has that once, plane values twice.
inline constexpr float kRoundingShare = 0.125F * kPlaneScale;
/// Rounding from which nothing is sure, either.
inline constexpr float kMostRounding = 1e9F;
/// The doubt of leaves that are too near: no value is sure.
inline constexpr std::int32_t kNothingSure = 0x7FFFFFFF;

/// Children of node n that exist.
[[nodiscard]] inline std::uint32_t existing(std::size_t children, std::uint32_t n) {
  const std::size_t left = children - 8 * std::size_t{n};
  return left >= 8 ? 0xFFU : (1U << left) - 1;
}

/// Asks for nodes that will be tested a few nodes on.
inline void prefetchNodes(
    const std::vector<Node>& nodes,
    std::span<const std::uint32_t> parents,
    std::size_t i) {
  constexpr std::size_t kAhead = 6;
  if (i + kAhead >= parents.size()) return;
  const auto* next = reinterpret_cast<const char*>(&nodes[parents[i + kAhead]]);
  for (std::size_t line = 0; line < sizeof(Node); line += 64)
    __builtin_prefetch(next + line);
}

/// Sides of a leaf's sites, bit i: site i is front. doubtful: those that the field must decide.
template <class Leaf>
[[nodiscard]] std::uint32_t settleDoubts(
    const Query& query,
    const OpenLeaf& open,
    const Leaf& leaf,
    std::uint32_t front,
    std::uint32_t doubtful);

extern template std::uint32_t settleDoubts<EdgeLeaf>(
    const Query&,
    const OpenLeaf&,
    const EdgeLeaf&,
    std::uint32_t,
    std::uint32_t);
extern template std::uint32_t settleDoubts<FaceLeaf>(
    const Query&,
    const OpenLeaf&,
    const FaceLeaf&,
    std::uint32_t,
    std::uint32_t);

/// Collects found items in pieces: a vector that grows by a few at a time clears what it is about
/// to be given.
class HitBuffer {
 public:
  explicit HitBuffer(std::vector<std::uint32_t>& out) : out_(&out) {}

  ~HitBuffer() { flush(); }

  HitBuffer(const HitBuffer&) = delete;
  HitBuffer& operator=(const HitBuffer&) = delete;

  /// Room for a leaf's items and a few more.
  [[nodiscard]] std::uint32_t* room() {
    if (count_ + kMost > held_.size()) flush();
    return held_.data() + count_;
  }

  void added(std::size_t count) { count_ += count; }

 private:
  static constexpr std::size_t kMost = 64;

  void flush() {
    out_->insert(out_->end(), held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(count_));
    count_ = 0;
  }

  std::vector<std::uint32_t>* out_;
  std::size_t count_ = 0;
  std::array<std::uint32_t, 1024> held_;
};

/// The faces of a leaf's sites (edges) or items.
inline const FaceId*
facesOf(const ConeTree& tree, std::uint32_t leafIndex, const EdgeLeaf& /*leaf*/) {
  return tree.siteFaces.data() + kLeafSites * std::size_t{leafIndex};
}

inline const FaceId*
facesOf(const ConeTree& tree, std::uint32_t /*leafIndex*/, const FaceLeaf& leaf) {
  return tree.faces.data() + leaf.itemBegin;
}

/// Adds the items that a leaf's hits name, four at a time: how many there are cannot be foretold,
/// and a wrong guess costs more than a few writes past the end.
template <class Leaf>
inline void
collect(const Leaf& leaf, const FaceId* faces, const LeafHits& found, HitBuffer& buffer) {
  std::uint32_t* out = buffer.room();
  const auto idOf = [&](std::size_t i) {
    if constexpr (Leaf::kSitesPerItem == 2) {
      const std::uint8_t side = leaf.sites[~(found.firstIsFront >> i) & 1U][i];
      return 3 * faces[side & 31U] + (side >> 5);
    } else {
      return faces[i];
    }
  };
  const int count = std::popcount(found.differing);
  std::uint64_t hits = found.differing;
  for (int n = 0; n < count; n += 4) {
    for (int k = 0; k < 4; ++k) {
      *out++ = idOf(static_cast<std::size_t>(std::countr_zero(hits)) & 63U);  // none left: item 0
      hits &= hits - 1;
    }
  }
  buffer.added(static_cast<std::size_t>(count));
}

template <class Leaf>
[[nodiscard]] inline const std::vector<Leaf>& leavesOf(const ConeTree& tree) {
  if constexpr (std::is_same_v<Leaf, EdgeLeaf>) {
    return tree.edgeLeaves;
  } else {
    return tree.faceLeaves;
  }
}

/// Asks for the leaf that will be tested a few leaves on.
template <class Leaf>
inline void prefetchAhead(const std::vector<Leaf>& all, const OpenLeaves& leaves, std::size_t i) {
  constexpr std::size_t kAhead = 4;
  if (i + kAhead >= leaves.count) return;
  const auto* next = reinterpret_cast<const char*>(&all[leaves.leaf[i + kAhead]]);
  for (std::size_t line = 0; line < sizeof(Leaf); line += 64)
    __builtin_prefetch(next + line);
}

/// Tests leaves with testLeaf(query, open leaf, leaf) → LeafHits, and collects what they hold with
/// collectLeaf(leaf, faces, hits, buffer). Leaves are tested in batches and collected after: which
/// of them hold anything cannot be foretold, so it is no branch, and the names of what they hold
/// are fetched meanwhile.
template <class Leaf, class Test, class Collect>
inline __attribute__((always_inline)) void searchWith(
    const Query& query,
    const OpenLeaves& leaves,
    SilhouetteResult& result,
    std::span<std::uint8_t> hits,
    Test testLeaf,
    Collect collectLeaf) {
  struct Hit {
    const Leaf* leaf;
    const FaceId* faces;
    std::uint32_t index;
    LeafHits found;
  };

  constexpr std::size_t kBatch = 32;
  constexpr std::size_t kFacesInLine = 64 / sizeof(FaceId);
  const std::vector<Leaf>& all = leavesOf<Leaf>(*query.tree);
  HitBuffer buffer(std::is_same_v<Leaf, EdgeLeaf> ? result.edges : result.faces);
  std::array<Hit, kBatch + 1> held;
  std::uint32_t sites = 0;
  std::uint32_t items = 0;
  for (std::size_t begin = 0; begin < leaves.count; begin += kBatch) {
    const std::size_t end = std::min(begin + kBatch, leaves.count);
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      prefetchAhead(all, leaves, i);
      const OpenLeaf open = leaves[i];
      const Leaf& leaf = all[open.leaf];
      sites += leaf.siteCount;
      items += leaf.itemCount;
      const FaceId* faces = facesOf(*query.tree, open.leaf, leaf);
      held[count] = {&leaf, faces, open.leaf, testLeaf(query, open, leaf)};
      __builtin_prefetch(faces);
      __builtin_prefetch(faces + kFacesInLine);
      count += held[count].found.differing != 0 ? 1 : 0;
    }
    for (std::size_t h = 0; h < count; ++h) {
      collectLeaf(*held[h].leaf, held[h].faces, held[h].found, buffer);
      if (!hits.empty()) hits[held[h].index] = kHit;
    }
  }
  result.stats.sitesTested += sites;
  result.stats.facesVisited += std::is_same_v<Leaf, FaceLeaf> ? items : sites;
}

}  // namespace limn::silhouette
