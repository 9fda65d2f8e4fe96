// SPDX-License-Identifier: Apache-2.0
// The loops of cones.cpp eight lanes at a time. Planes: the same operations in the same order, so
// the same bits. Cones: within the slack they allow for.
#include "shared/silhouette/cones_search.h"
#include "shared/view/anchored_cone.h"

#if LIMN_SILHOUETTE_AVX2

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

LIMN_TARGET_AVX2 inline std::uint32_t openOf(const Node& node, const Eye8& eye, __m256 slack) {
  const __m256 zero = _mm256_setzero_ps();
  const __m256 qx = relative(eye.x, node.centerX.data(), eye.w);
  const __m256 qy = relative(eye.y, node.centerY.data(), eye.w);
  const __m256 qz = relative(eye.z, node.centerZ.data(), eye.w);
  const __m256 along =
      dot(qx,
          qy,
          qz,
          _mm256_load_ps(node.axisX.data()),
          _mm256_load_ps(node.axisY.data()),
          _mm256_load_ps(node.axisZ.data()));
  const __m256 square = dot(qx, qy, qz, qx, qy, qz);
  const __m256 across = _mm256_add_ps(
      _mm256_sub_ps(square, _mm256_mul_ps(along, along)),
      _mm256_mul_ps(_mm256_set1_ps(ConeSlack::kSquare), square));
  const __m256 front = _mm256_mul_ps(_mm256_load_ps(node.front.data()), eye.w);
  const __m256 back = _mm256_mul_ps(_mm256_load_ps(node.back.data()), eye.w);
  const __m256 inFront = _mm256_sub_ps(_mm256_sub_ps(along, front), slack);
  const __m256 inBack = _mm256_add_ps(_mm256_sub_ps(along, back), slack);
  // At most one of the two is on its cone's side: back ≤ front.
  const __m256 isInFront = _mm256_cmp_ps(inFront, zero, _CMP_GT_OQ);
  const __m256 isInBack = _mm256_cmp_ps(inBack, zero, _CMP_LT_OQ);
  const __m256 depth =
      _mm256_or_ps(_mm256_and_ps(isInFront, inFront), _mm256_andnot_ps(isInFront, inBack));
  const __m256 reach =
      _mm256_mul_ps(_mm256_mul_ps(depth, depth), _mm256_load_ps(node.cotSquared.data()));
  const __m256 closed =
      _mm256_and_ps(_mm256_or_ps(isInFront, isInBack), _mm256_cmp_ps(reach, across, _CMP_GE_OQ));
  return node.children & ~static_cast<std::uint32_t>(_mm256_movemask_ps(closed));
}

// All ones where the planes of eight slots are front.
LIMN_TARGET_AVX2 inline __m256i frontOfEight(const Leaf& leaf, std::size_t s, const Eye8& eye) {
  __m256 value = _mm256_mul_ps(_mm256_load_ps(&leaf.x[s]), eye.x);
  value = _mm256_add_ps(value, _mm256_mul_ps(_mm256_load_ps(&leaf.y[s]), eye.y));
  value = _mm256_add_ps(value, _mm256_mul_ps(_mm256_load_ps(&leaf.z[s]), eye.z));
  value = _mm256_add_ps(value, _mm256_mul_ps(_mm256_load_ps(&leaf.w[s]), eye.w));
  return _mm256_castps_si256(_mm256_cmp_ps(value, _mm256_setzero_ps(), _CMP_GT_OQ));
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

LIMN_TARGET_AVX2 inline __m256i
differing(const FacingTable& table, __m256i first, __m256i b, __m256i c) {
  return _mm256_or_si256(
      _mm256_xor_si256(first, lookUp(table, b)),
      _mm256_xor_si256(first, lookUp(table, c)));
}

LIMN_TARGET_AVX2 inline LeafHits testLeaf(const Leaf& leaf, const Eye8& eye) {
  const __m256i ab = _mm256_packs_epi32(frontOfEight(leaf, 0, eye), frontOfEight(leaf, 8, eye));
  const __m256i cd = _mm256_packs_epi32(frontOfEight(leaf, 16, eye), frontOfEight(leaf, 24, eye));
  const __m256i front = _mm256_packs_epi16(ab, cd);
  LeafHits found;
  const std::uint64_t mask = maskOf(front);
  if (mask == 0 || mask == 0xFFFFFFFFU) return found;
  const FacingTable table = {
      _mm256_permute2x128_si256(front, front, 0x00),
      _mm256_permute2x128_si256(front, front, 0x11)};
  const auto& sites = leaf.sites;
  const __m256i first = lookUp(table, load32(sites[0].data()));
  found.differing =
      maskOf(differing(table, first, load32(sites[1].data()), load32(sites[2].data())));
  found.firstIsFront = maskOf(first);
  if (leaf.itemCount > 32) {
    const __m256i rest = lookUp(table, load16(sites[0].data() + 32));
    const std::uint64_t hits =
        maskOf(differing(table, rest, load16(sites[1].data() + 32), load16(sites[2].data() + 32)));
    found.differing |= (hits & 0xFFFFU) << 32;
    found.firstIsFront |= (maskOf(rest) & 0xFFFFU) << 32;
  }
  return found;
}

}  // namespace

LIMN_TARGET_AVX2 void openChildrenAvx2(
    std::span<const Node> level,
    std::span<const std::uint32_t> parents,
    const Query& query,
    std::vector<std::uint32_t>& open) {
  const Eye8 eye = broadcast(query.eye);
  const __m256 slack = _mm256_set1_ps(query.slack);
  for (const std::uint32_t n : parents)
    appendChildren(n, openOf(level[n], eye, slack), open);
}

LIMN_TARGET_AVX2 void searchLeavesAvx2(
    const ConeTree& tree,
    std::span<const std::uint32_t> leaves,
    const Query& query,
    SilhouetteResult& result) {
  const Eye8 eye = broadcast(query.eye);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    prefetchAhead(tree, leaves, i);
    const Leaf& leaf = tree.leaves[leaves[i]];
    collect(tree, leaf, testLeaf(leaf, eye), result);
  }
}

}  // namespace limn::silhouette

#endif
