// SPDX-License-Identifier: Apache-2.0
// The loops of cones.cpp eight lanes at a time. Planes: the same integers. Cones: within the slack
// they allow for.
#include "shared/silhouette/cones_search.h"
#include "shared/view/anchored_pyramid.h"

#if LIMN_HAS_AVX2

namespace limn::silhouette {
namespace {

struct Eye8 {
  __m256 x, y, z, w;
};

LIMN_TARGET_AVX2 inline Eye8 broadcast(const glm::vec4& eye) {
  return {
      _mm256_set1_ps(eye.x),
      _mm256_set1_ps(eye.y),
      _mm256_set1_ps(eye.z),
      _mm256_set1_ps(eye.w)};
}

LIMN_TARGET_AVX2 inline __m256
dot(__m256 ax, __m256 ay, __m256 az, __m256 bx, __m256 by, __m256 bz) {
  const __m256 xy = _mm256_add_ps(_mm256_mul_ps(ax, bx), _mm256_mul_ps(ay, by));
  return _mm256_add_ps(xy, _mm256_mul_ps(az, bz));
}

// eye − center · w
LIMN_TARGET_AVX2 inline __m256 relative(__m256 eye, const float* center, __m256 w) {
  return _mm256_sub_ps(eye, _mm256_mul_ps(_mm256_load_ps(center), w));
}

// Where the eye is from eight children.
struct ToEye8 {
  __m256 x, y, z;
};

LIMN_TARGET_AVX2 inline ToEye8 toEyeOf(const Node& node, const Eye8& eye) {
  return {
      relative(eye.x, node.centerX.data(), eye.w),
      relative(eye.y, node.centerY.data(), eye.w),
      relative(eye.z, node.centerZ.data(), eye.w)};
}

LIMN_TARGET_AVX2 inline __m256i load8(const std::uint16_t* values) {
  return _mm256_cvtepu16_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(values)));
}

LIMN_TARGET_AVX2 inline __m256 load8(const std::array<std::int16_t, 8>& values) {
  const __m128i shorts = _mm_load_si128(reinterpret_cast<const __m128i*>(values.data()));
  return _mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(shorts));
}

LIMN_TARGET_AVX2 inline __m256 along(
    const std::array<std::array<std::int16_t, 8>, 3>& vectors,
    const ToEye8& q) {
  return dot(q.x, q.y, q.z, load8(vectors[0]), load8(vectors[1]), load8(vectors[2]));
}

LIMN_TARGET_AVX2 inline std::uint32_t
openOf(const Node& node, const Eye8& eye, const ToEye8& q, __m256 slack) {
  const __m256 sign = _mm256_set1_ps(-0.0F);
  const __m256 middle = along(node.axis, q);
  const __m256 across = _mm256_add_ps(
      _mm256_add_ps(
          _mm256_andnot_ps(sign, along(node.side1, q)),
          _mm256_andnot_ps(sign, along(node.side2, q))),
      slack);
  const __m256 front = _mm256_mul_ps(_mm256_load_ps(node.front.data()), eye.w);
  const __m256 back = _mm256_mul_ps(_mm256_load_ps(node.back.data()), eye.w);
  const __m256 isFront = _mm256_cmp_ps(_mm256_add_ps(middle, front), across, _CMP_GT_OQ);
  const __m256 isBack =
      _mm256_cmp_ps(_mm256_add_ps(middle, back), _mm256_xor_ps(across, sign), _CMP_LT_OQ);
  return ~static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_or_ps(isFront, isBack))) & 0xFFU;
}

// By mask of eight: the lanes that it names, one after the other.
struct LaneTable {
  alignas(64) std::array<std::array<std::uint8_t, 8>, 256> lanes;
};

constexpr LaneTable kLanes = [] {
  LaneTable table{};
  for (std::uint32_t mask = 0; mask < 256; ++mask) {
    std::size_t count = 0;
    for (std::uint8_t i = 0; i < 8; ++i) {
      if ((mask >> i & 1U) != 0) table.lanes[mask][count++] = i;
    }
  }
  return table;
}();

LIMN_TARGET_AVX2 inline __m256i lanesOf(std::uint32_t mask) {
  return _mm256_cvtepu8_epi32(
      _mm_loadl_epi64(reinterpret_cast<const __m128i*>(kLanes.lanes[mask].data())));
}

template <class Word>
LIMN_TARGET_AVX2 inline void store8(Word* to, __m256i words) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), words);
}

// The eight children of a node.
LIMN_TARGET_AVX2 inline __m256i childrenOf(std::uint32_t node) {
  return _mm256_add_epi32(
      _mm256_set1_epi32(static_cast<int>(8 * node)),
      _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
}

// Eight leaves as a list has them.
struct Leaves8 {
  __m256i leaf, eyeXy, eyeZw, doubt;
};

// A list being added to. Held apart: every vector that is stored might otherwise have changed where
// the list is.
class LeafWriter {
 public:
  // Room for `most`; null: nothing will be added.
  LeafWriter(OpenLeaves* open, std::size_t most) : open_(open) {
    if (open == nullptr) return;
    open->makeRoom(most + 8);
    leaf_ = open->leaf.data();
    eyeXy_ = open->eyeXy.data();
    eyeZw_ = open->eyeZw.data();
    doubt_ = open->doubt.data();
    count_ = open->count;
  }

  // Those that the mask names: eight are written, however many count.
  LIMN_TARGET_AVX2 inline __attribute__((always_inline)) void append(
      const Leaves8& leaves,
      std::uint32_t mask) {
    const __m256i lanes = lanesOf(mask);
    store8(leaf_ + count_, _mm256_permutevar8x32_epi32(leaves.leaf, lanes));
    store8(eyeXy_ + count_, _mm256_permutevar8x32_epi32(leaves.eyeXy, lanes));
    store8(eyeZw_ + count_, _mm256_permutevar8x32_epi32(leaves.eyeZw, lanes));
    store8(doubt_ + count_, _mm256_permutevar8x32_epi32(leaves.doubt, lanes));
    count_ += static_cast<std::size_t>(std::popcount(mask));
  }

  void finish() const {
    if (open_ != nullptr) open_->count = count_;
  }

 private:
  OpenLeaves* open_;
  std::uint32_t* leaf_ = nullptr;
  std::int32_t* eyeXy_ = nullptr;
  std::int32_t* eyeZw_ = nullptr;
  std::int32_t* doubt_ = nullptr;
  std::size_t count_ = 0;
};

// 1 / √x to within 2⁻²²: the estimate (2⁻¹¹) and one step of Newton's.
LIMN_TARGET_AVX2 inline __m256 inverseRoot(__m256 x) {
  const __m256 guess = _mm256_rsqrt_ps(x);
  const __m256 half = _mm256_mul_ps(_mm256_set1_ps(0.5F), _mm256_mul_ps(x, guess));
  return _mm256_mul_ps(guess, _mm256_sub_ps(_mm256_set1_ps(1.5F), _mm256_mul_ps(half, guess)));
}

// Rounded to 16 bits each: the first in the low halves, the second in the high ones.
LIMN_TARGET_AVX2 inline __m256i pairs(__m256 low, __m256 high) {
  return _mm256_blend_epi16(
      _mm256_cvtps_epi32(low),
      _mm256_slli_epi32(_mm256_cvtps_epi32(high), 16),
      0xAA);
}

// A leaf's facing as a table of 32 bytes, each half in both lanes.
struct FacingTable {
  __m256i low, high;
};

// Looks up 32 indices below 32: both halves by shuffles, chosen by bit 4.
LIMN_TARGET_AVX2 inline __m256i lookUp(const FacingTable& table, __m256i index) {
  const __m256i chooseHigh = _mm256_slli_epi16(index, 3);
  return _mm256_blendv_epi8(
      _mm256_shuffle_epi8(table.low, index),
      _mm256_shuffle_epi8(table.high, index),
      chooseHigh);
}

LIMN_TARGET_AVX2 inline std::uint64_t maskOf(__m256i bytes) {
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(bytes));
}

LIMN_TARGET_AVX2 inline __m256i load32(const std::uint8_t* bytes) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes));
}

LIMN_TARGET_AVX2 inline __m256i load16(const std::uint8_t* bytes) {
  return _mm256_zextsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes)));
}

// Bit i of the mask as byte i, all ones or none.
LIMN_TARGET_AVX2 inline __m256i bytesOf(std::uint32_t mask) {
  const __m256i spread = _mm256_shuffle_epi8(
      _mm256_set1_epi32(static_cast<int>(mask)),
      _mm256_setr_epi64x(0, 0x0101010101010101, 0x0202020202020202, 0x0303030303030303));
  const __m256i bit = _mm256_set1_epi64x(static_cast<long long>(0x8040201008040201ULL));
  return _mm256_cmpeq_epi8(_mm256_and_si256(spread, bit), bit);
}

// Four comparisons of eight as bytes in the order of sites.
LIMN_TARGET_AVX2 inline __m256i packed(__m256i a, __m256i b, __m256i c, __m256i d) {
  return _mm256_packs_epi16(_mm256_packs_epi32(a, b), _mm256_packs_epi32(c, d));
}

// Items `rows` bytes on: which differ, and which have site [0] in front.
template <class Leaf, class Load>
LIMN_TARGET_AVX2 inline __attribute__((always_inline)) LeafHits
lookUpItems(const FacingTable& table, const Leaf& leaf, std::size_t from, Load load) {
  const __m256i first = lookUp(table, load(leaf.sites[0].data() + from));
  __m256i differs = _mm256_xor_si256(first, lookUp(table, load(leaf.sites[1].data() + from)));
  if constexpr (Leaf::kSitesPerItem == 3) {
    const __m256i third = lookUp(table, load(leaf.sites[2].data() + from));
    differs = _mm256_or_si256(differs, _mm256_xor_si256(first, third));
  }
  return {maskOf(differs), maskOf(first)};
}

template <class Leaf>
LIMN_TARGET_AVX2 inline __attribute__((always_inline)) LeafHits
testLeaf(const Query& query, const OpenLeaf& open, const Leaf& leaf) {
  const __m256i eyeXy = _mm256_set1_epi32(open.eyeXy);
  const __m256i eyeZw = _mm256_set1_epi32(open.eyeZw);
  const __m256i above = _mm256_set1_epi32(open.doubt);
  const __m256i below = _mm256_set1_epi32(-open.doubt - 1);
  __m256i isFront[4];
  __m256i isNotBack[4];
  for (std::size_t j = 0; j < 4; ++j) {
    const auto* xy = reinterpret_cast<const __m256i*>(leaf.xy.data() + 16 * j);
    const auto* zd = reinterpret_cast<const __m256i*>(leaf.zd.data() + 16 * j);
    const __m256i value = _mm256_add_epi32(
        _mm256_madd_epi16(_mm256_load_si256(xy), eyeXy),
        _mm256_madd_epi16(_mm256_load_si256(zd), eyeZw));
    isFront[j] = _mm256_cmpgt_epi32(value, above);
    isNotBack[j] = _mm256_cmpgt_epi32(value, below);
  }
  __m256i front = packed(isFront[0], isFront[1], isFront[2], isFront[3]);
  const __m256i notBack = packed(isNotBack[0], isNotBack[1], isNotBack[2], isNotBack[3]);
  auto mask = static_cast<std::uint32_t>(maskOf(front));
  const auto doubtful = mask ^ static_cast<std::uint32_t>(maskOf(notBack));
  if (doubtful != 0) [[unlikely]] {
    mask = settleDoubts(query, open, leaf, mask, doubtful);
    front = bytesOf(mask);
  }
  const FacingTable table = {
      _mm256_permute2x128_si256(front, front, 0x00),
      _mm256_permute2x128_si256(front, front, 0x11)};
  // Always both parts: how many items a leaf has is past guessing.
  LeafHits found = lookUpItems(table, leaf, 0, load32);
  const LeafHits rest = lookUpItems(table, leaf, 32, load16);
  found.differing |= rest.differing << 32;
  found.firstIsFront |= rest.firstIsFront << 32;
  // A row may end before the bytes read.
  found.differing &= (std::uint64_t{1} << leaf.itemCount) - 1;
  return found;
}

}  // namespace

LIMN_TARGET_AVX2 void openChildrenAvx2(
    const Query& query,
    std::size_t level,
    std::span<const std::uint32_t> parents,
    OpenNodes& open) {
  const std::vector<Node>& nodes = query.tree->levels[level];
  const std::size_t children = query.tree->childrenOf(level);
  const Eye8 eye = broadcast(query.eye);
  const __m256 slack = _mm256_set1_ps(query.slack);
  open.makeRoom(8 * parents.size() + 8);
  std::uint32_t* out = open.nodes.data() + open.count;
  for (std::size_t p = 0; p < parents.size(); ++p) {
    prefetchNodes(nodes, parents, p);
    const std::uint32_t n = parents[p];
    const std::uint32_t mask =
        openOf(nodes[n], eye, toEyeOf(nodes[n], eye), slack) & existing(children, n);
    store8(out, _mm256_permutevar8x32_epi32(childrenOf(n), lanesOf(mask)));
    out += std::popcount(mask);
  }
  open.count = static_cast<std::size_t>(out - open.nodes.data());
}

LIMN_TARGET_AVX2 void
openLeavesAvx2(const Query& query, std::span<const std::uint32_t> parents, const LeafLists& lists) {
  const std::vector<Node>& nodes = query.tree->levels[0];
  const std::size_t leaves = query.tree->leafCount();
  const Eye8 eye = broadcast(query.eye);
  const __m256 slack = _mm256_set1_ps(query.slack);
  const __m256 scale = _mm256_set1_ps(kPlaneScale);
  const __m256 nearest = _mm256_set1_ps(kNearest);
  const __m256 rounding = _mm256_set1_ps(query.slack * kRoundingShare);
  const bool hasFirsts = !lists.lastHits.empty();
  LeafWriter others(lists.others, 8 * parents.size());
  LeafWriter firsts(hasFirsts ? lists.firsts : nullptr, 8 * parents.size());
  for (std::size_t p = 0; p < parents.size(); ++p) {
    prefetchNodes(nodes, parents, p);
    const std::uint32_t n = parents[p];
    const ToEye8 q = toEyeOf(nodes[n], eye);
    const std::uint32_t mask = openOf(nodes[n], eye, q, slack) & existing(leaves, n);
    const __m256 square = dot(q.x, q.y, q.z, q.x, q.y, q.z);
    const __m256 inverse = inverseRoot(_mm256_max_ps(square, _mm256_set1_ps(1e-30F)));
    const __m256 factor = _mm256_mul_ps(inverse, scale);
    const __m256 radius = _mm256_castsi256_ps(_mm256_slli_epi32(load8(nodes[n].radius.data()), 16));
    const __m256 nearness = _mm256_mul_ps(_mm256_mul_ps(radius, eye.w), inverse);
    const __m256 roundings = _mm256_mul_ps(rounding, inverse);
    const __m256 isSure = _mm256_and_ps(
        _mm256_cmp_ps(nearness, nearest, _CMP_LE_OQ),
        _mm256_cmp_ps(roundings, _mm256_set1_ps(kMostRounding), _CMP_LT_OQ));
    const __m256i doubt = _mm256_cvtps_epi32(_mm256_add_ps(roundings, _mm256_set1_ps(kPlaneError)));
    const Leaves8 open = {
        childrenOf(n),
        pairs(_mm256_mul_ps(q.x, factor), _mm256_mul_ps(q.y, factor)),
        pairs(_mm256_mul_ps(q.z, factor), _mm256_mul_ps(_mm256_min_ps(nearness, nearest), scale)),
        _mm256_blendv_epi8(_mm256_set1_epi32(kNothingSure), doubt, _mm256_castps_si256(isSure))};
    if (!hasFirsts) {
      others.append(open, mask);
      continue;
    }
    const auto* last = reinterpret_cast<const __m128i*>(lists.lastHits.data() + 8 * std::size_t{n});
    const auto hits = static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_loadl_epi64(last)));
    firsts.append(open, mask & hits);
    others.append(open, mask & ~hits);
  }
  others.finish();
  firsts.finish();
}

LIMN_TARGET_AVX2 void searchLeavesAvx2(
    const Query& query,
    const OpenLeaves& leaves,
    SilhouetteResult& result,
    std::span<std::uint8_t> hits) {
  if (result.kind == SilhouetteKind::kEdges) {
    searchWith<EdgeLeaf>(query, leaves, result, hits, testLeaf<EdgeLeaf>, collect<EdgeLeaf>);
  } else {
    searchWith<FaceLeaf>(query, leaves, result, hits, testLeaf<FaceLeaf>, collect<FaceLeaf>);
  }
}

}  // namespace limn::silhouette

#endif
