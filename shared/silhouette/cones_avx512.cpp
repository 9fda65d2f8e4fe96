// SPDX-License-Identifier: Apache-2.0
// Leaves in 64-byte vectors: a leaf's sides are one table that byte permutations look up, and what
// it holds is packed and named without a loop. The same integers as in cones.cpp.
#include "shared/silhouette/cones_search.h"

#if LIMN_HAS_AVX2

namespace limn::silhouette {
namespace {

// Where the plane of each local site is (LeafOf::slotOf), twice: indices have a sixth bit.
struct SlotTable {
  alignas(64) std::array<std::uint8_t, 64> slots;
};

constexpr SlotTable kSlots = [] {
  SlotTable table{};
  for (std::size_t i = 0; i < 64; ++i)
    table.slots[i] = static_cast<std::uint8_t>(EdgeLeaf::slotOf(i % kLeafSites));
  return table;
}();

// Bits in the order of slots as bytes in the order of sites, twice.
LIMN_TARGET_AVX512 inline __m512i bySites(std::uint32_t slots) {
  return _mm512_permutexvar_epi8(_mm512_load_si512(kSlots.slots.data()), _mm512_movm_epi8(slots));
}

LIMN_TARGET_AVX512 inline __m512i load64(const std::uint8_t* bytes) {
  return _mm512_loadu_si512(bytes);
}

template <class Leaf>
LIMN_TARGET_AVX512 inline __attribute__((always_inline)) LeafHits
testLeaf(const Query& query, const OpenLeaf& open, const Leaf& leaf) {
  const __m512i eyeXy = _mm512_set1_epi32(open.eyeXy);
  const __m512i eyeZw = _mm512_set1_epi32(open.eyeZw);
  const __m512i above = _mm512_set1_epi32(open.doubt);
  const __m512i below = _mm512_set1_epi32(-open.doubt - 1);
  std::uint32_t front = 0;
  std::uint32_t notBack = 0;
  for (std::size_t j = 0; j < 2; ++j) {
    const __m512i value = _mm512_add_epi32(
        _mm512_madd_epi16(_mm512_loadu_si512(leaf.xy.data() + 32 * j), eyeXy),
        _mm512_madd_epi16(_mm512_loadu_si512(leaf.zd.data() + 32 * j), eyeZw));
    front |= static_cast<std::uint32_t>(_mm512_cmpgt_epi32_mask(value, above)) << (16 * j);
    notBack |= static_cast<std::uint32_t>(_mm512_cmpgt_epi32_mask(value, below)) << (16 * j);
  }
  __m512i table = bySites(front);
  if (front != notBack) [[unlikely]] {
    const auto known = static_cast<std::uint32_t>(_mm512_movepi8_mask(table));
    const auto doubtful = static_cast<std::uint32_t>(_mm512_movepi8_mask(bySites(front ^ notBack)));
    const std::uint32_t settled = settleDoubts(query, open, leaf, known, doubtful);
    table = _mm512_movm_epi8(std::uint64_t{settled} << 32 | settled);
  }
  const __m512i first = _mm512_permutexvar_epi8(load64(leaf.sites[0].data()), table);
  const __m512i second = _mm512_permutexvar_epi8(load64(leaf.sites[1].data()), table);
  std::uint64_t differing = _mm512_cmpneq_epi8_mask(first, second);
  if constexpr (Leaf::kSitesPerItem == 3) {
    const __m512i third = _mm512_permutexvar_epi8(load64(leaf.sites[2].data()), table);
    differing |= _mm512_cmpneq_epi8_mask(first, third);
  }
  // A row may end before the bytes read.
  differing &= (std::uint64_t{1} << leaf.itemCount) - 1;
  return {differing, _mm512_movepi8_mask(first)};
}

// Up to kLeafEdges half-edges, in pieces of sixteen.
LIMN_TARGET_AVX512 inline __attribute__((always_inline)) void
collect(const EdgeLeaf& leaf, const FaceId* faces, const LeafHits& found, HitBuffer& buffer) {
  std::uint32_t* out = buffer.room();
  const __m512i sides = _mm512_mask_blend_epi8(
      found.firstIsFront,
      load64(leaf.sites[1].data()),
      load64(leaf.sites[0].data()));
  __m512i packed = _mm512_maskz_compress_epi8(found.differing, sides);
  const __m512i low = _mm512_loadu_si512(faces);
  const __m512i high = _mm512_loadu_si512(faces + 16);
  const int count = std::popcount(found.differing);
  for (int n = 0; n < count; n += 16) {
    const __m512i side = _mm512_cvtepu8_epi32(_mm512_castsi512_si128(packed));
    const __m512i face = _mm512_permutex2var_epi32(low, side, high);  // by the low five bits
    const __m512i halfEdge = _mm512_add_epi32(
        _mm512_add_epi32(face, _mm512_slli_epi32(face, 1)),
        _mm512_srli_epi32(side, 5));
    _mm512_storeu_si512(out + n, halfEdge);
    packed = _mm512_shuffle_i32x4(packed, packed, 0x39);  // the next sixteen bytes
  }
  buffer.added(static_cast<std::size_t>(count));
}

LIMN_TARGET_AVX512 inline __attribute__((always_inline)) void
collect(const FaceLeaf& leaf, const FaceId* faces, const LeafHits& found, HitBuffer& buffer) {
  std::uint32_t* out = buffer.room();
  for (std::size_t n = 0; n < leaf.itemCount; n += 16) {
    const auto mask = static_cast<__mmask16>(found.differing >> n);
    const __m512i names = _mm512_maskz_loadu_epi32(mask, faces + n);
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(mask, names));
    out += std::popcount(static_cast<std::uint32_t>(mask));
  }
  buffer.added(static_cast<std::size_t>(std::popcount(found.differing)));
}

}  // namespace

LIMN_TARGET_AVX512 void searchLeavesAvx512(
    const Query& query,
    const OpenLeaves& leaves,
    SilhouetteResult& result,
    std::span<std::uint8_t> hits) {
  if (result.kind == SilhouetteKind::kEdges) {
    searchWith<EdgeLeaf>(
        query,
        leaves,
        result,
        hits,
        testLeaf<EdgeLeaf>,
        [](const EdgeLeaf& leaf, const FaceId* faces, const LeafHits& found, HitBuffer& buffer)
            LIMN_TARGET_AVX512 { collect(leaf, faces, found, buffer); });
  } else {
    searchWith<FaceLeaf>(
        query,
        leaves,
        result,
        hits,
        testLeaf<FaceLeaf>,
        [](const FaceLeaf& leaf, const FaceId* faces, const LeafHits& found, HitBuffer& buffer)
            LIMN_TARGET_AVX512 { collect(leaf, faces, found, buffer); });
  }
}

}  // namespace limn::silhouette

#endif
