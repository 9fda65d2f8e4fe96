// SPDX-License-Identifier: Apache-2.0
// Based on: A. Hertzmann, D. Zorin, "Illustrating Smooth Surfaces", SIGGRAPH 2000 (one segment a
// crossed face).
// Deviations: each segment is named on its own, so that memory accesses overlap and can be asked
// for ahead; nothing that cannot be foretold is a branch.
#include "client/stroke/chain/chain_crossings.h"

#include "shared/core/simd.h"

#include <algorithm>
#include <array>
#include <bit>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace limn::chaining {
namespace {

// No segment's.
constexpr Passage kNoPassage = {~std::uint64_t{0}, ~std::uint64_t{0}};

// Through which edges the silhouette passes a face, as corners: it enters from a front to a back
// corner (in the face's order) and leaves the other way round. In the order of a Passage's words.
struct Way {
  std::uint8_t enterBack, enterFront, leaveBack, leaveFront;
};

// By the sides of the corners (bit k: corner k is front). One of them is alone on its side; the
// edges are its two.
constexpr std::array<Way, 8> kWays = [] {
  std::array<Way, 8> ways{};
  for (std::uint32_t mask = 1; mask < 7; ++mask) {
    const bool isFront = std::popcount(mask) == 1;
    const auto alone = static_cast<std::uint8_t>(std::countr_zero(isFront ? mask : 7U - mask));
    const auto next = static_cast<std::uint8_t>((alone + 1) % 3);
    const auto before = static_cast<std::uint8_t>((alone + 2) % 3);
    ways[mask] = isFront ? Way{next, alone, before, alone} : Way{alone, before, alone, next};
  }
  return ways;
}();

// What naming reads and writes, as bare pointers; by value, so that no store may change them.
struct Naming {
  const VertexSite* vertices;
  const std::uint32_t* origins;
  const FaceId* faces;
  std::size_t count;
  Passage* passages;
  std::uint32_t* keys;
  glm::vec4* ends;
};

// Asks for what faces further on need: first for their corners, then for those corners' vertices.
inline __attribute__((always_inline)) void prefetchAhead(const Naming& naming, std::size_t i) {
  constexpr std::size_t kFarAhead = 64;
  constexpr std::size_t kNearAhead = 24;
  const std::size_t last = naming.count - 1;
  __builtin_prefetch(&naming.origins[3 * naming.faces[std::min(i + kFarAhead, last)]]);
  const std::uint32_t* ahead = &naming.origins[3 * naming.faces[std::min(i + kNearAhead, last)]];
  for (std::uint32_t k = 0; k < 3; ++k)
    __builtin_prefetch(&naming.vertices[ahead[k]]);
}

void namePortable(const Naming naming, const glm::vec4& eye) {
  const VertexSite* vertices = naming.vertices;
  for (std::size_t i = 0; i < naming.count; ++i) {
    prefetchAhead(naming, i);
    const std::uint32_t* corners = &naming.origins[3 * naming.faces[i]];
    std::array<float, 3> values{};
    std::uint32_t sides = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      values[k] = SilhouetteField::valueAt(vertices[corners[k]].plane, eye);
      sides |= static_cast<std::uint32_t>(values[k] > 0.0F) << k;
    }
    const Way way = kWays[sides];
    const std::uint32_t front = corners[way.leaveFront];
    const std::uint32_t back = corners[way.leaveBack];
    naming.passages[i] = {
        crossingName(corners[way.enterFront], corners[way.enterBack]),
        crossingName(front, back)};
    naming.keys[i] = keyOf(naming.passages[i].from);
    // SmoothWalk::exitPoint, to the last bit: positions are exact.
    const float t = values[way.leaveFront] / (values[way.leaveFront] - values[way.leaveBack]);
    const glm::vec4& from = vertices[front].position;
    naming.ends[i] = from + t * (vertices[back].position - from);
  }
}

// Of the 2 kNear keys from `keys`, those that are `key`.
inline std::uint32_t equalKeysPortable(const std::uint32_t* keys, std::uint32_t key) {
#if defined(__SSE2__)
  const __m128i wanted = _mm_set1_epi32(static_cast<int>(key));
  const auto same = [&](std::size_t i) {
    return _mm_cmpeq_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(keys + i)), wanted);
  };
  const auto sixteen = [&](std::size_t i) {
    const __m128i low = _mm_packs_epi32(same(i), same(i + 4));
    const __m128i high = _mm_packs_epi32(same(i + 8), same(i + 12));
    return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(low, high)));
  };
  static_assert(kNear == 16);
  return sixteen(16) << 16 | sixteen(0);
#else
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < 2 * kNear; ++i)
    mask |= static_cast<std::uint32_t>(keys[i] == key) << i;
  return mask;
#endif
}

template <class EqualKeys>
inline __attribute__((always_inline)) void
join(const Crossings& crossings, NearJoins& joins, EqualKeys equalKeys) {
  const std::size_t count = crossings.ends.size();
  const Passage* passages = crossings.passages.data() + kNear;
  const std::uint32_t* keys = crossings.keys.data();
  std::uint32_t* next = joins.next.data();
  std::uint8_t* isContinued = joins.isContinued.data();
  joins.unjoined.resize(count);
  std::uint32_t* unjoined = joins.unjoined.data();
  std::size_t left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t wanted = passages[i].to;
    const std::uint64_t same = equalKeys(keys + i, keyOf(wanted));
    // The first of them, else the last of the margin. Where keys are alike by chance, the table
    // finds the right one.
    const auto place =
        static_cast<std::size_t>(std::countr_zero(same | std::uint64_t{1} << (2 * kNear)));
    const auto isSame = static_cast<std::uint32_t>(passages[i + place - kNear].from == wanted);
    next[i] = static_cast<std::uint32_t>(i + place - kNear) | (isSame - 1);  // or kNone
    isContinued[(i + place) & (0 - std::size_t{isSame})] = 1;  // or the margin's first
    unjoined[left] = static_cast<std::uint32_t>(i);
    left += 1 - isSame;
  }
  joins.unjoined.resize(left);
}

#if LIMN_HAS_AVX2
// By the sides of the corners: bytes of four words in the order of a Passage's, of the corners'.
struct ShuffleTable {
  alignas(16) std::array<std::array<std::uint8_t, 16>, 8> bytes;
};

constexpr ShuffleTable kShuffles = [] {
  ShuffleTable table{};
  for (std::size_t mask = 0; mask < 8; ++mask) {
    const Way& way = kWays[mask];
    const std::array<std::uint8_t, 4> corners = {
        way.enterBack,
        way.enterFront,
        way.leaveBack,
        way.leaveFront};
    for (std::size_t b = 0; b < 16; ++b)
      table.bytes[mask][b] = static_cast<std::uint8_t>(4 * corners[b / 4] + b % 4);
  }
  return table;
}();

LIMN_TARGET_AVX2 void nameAvx2(const Naming naming, const glm::vec4& eye) {
  const __m128 e = _mm_loadu_ps(&eye.x);
  for (std::size_t i = 0; i < naming.count; ++i) {
    prefetchAhead(naming, i);
    const std::uint32_t* corners = &naming.origins[3 * naming.faces[i]];
    const auto product = [&](std::uint32_t v) LIMN_TARGET_AVX2 {
      return _mm_mul_ps(_mm_load_ps(&naming.vertices[v].plane.x), e);
    };
    // Turned round: one corner a lane, the fourth is nobody's.
    const __m128 a = product(corners[0]);
    const __m128 b = product(corners[1]);
    const __m128 c = product(corners[2]);
    const __m128 xy = _mm_unpacklo_ps(a, b);
    const __m128 zw = _mm_unpackhi_ps(a, b);
    const __m128 x = _mm_movelh_ps(xy, c);
    const __m128 y = _mm_shuffle_ps(xy, c, _MM_SHUFFLE(1, 1, 3, 2));
    const __m128 z = _mm_shuffle_ps(zw, c, _MM_SHUFFLE(2, 2, 1, 0));
    const __m128 w = _mm_shuffle_ps(zw, c, _MM_SHUFFLE(3, 3, 3, 2));
    // SilhouetteField::valueAt, to the last bit.
    const __m128 values = _mm_add_ps(_mm_add_ps(_mm_add_ps(x, y), z), w);
    const auto sides =
        static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmpgt_ps(values, _mm_setzero_ps()))) & 7U;
    const auto* shuffle = reinterpret_cast<const __m128i*>(kShuffles.bytes[sides].data());
    const __m128i order = _mm_load_si128(shuffle);
    const __m128i two = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(corners));
    const __m128i three = _mm_insert_epi32(two, static_cast<int>(corners[2]), 2);
    const __m128i passage = _mm_shuffle_epi8(three, order);
    _mm_store_si128(reinterpret_cast<__m128i*>(&naming.passages[i]), passage);
    naming.keys[i] = keyOf(static_cast<std::uint64_t>(_mm_cvtsi128_si64(passage)));
    const auto to = static_cast<std::uint64_t>(_mm_extract_epi64(passage, 1));
    // SmoothWalk::exitPoint, to the last bit.
    const __m128 passed = _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(values), order));
    const __m128 front = _mm_permute_ps(passed, _MM_SHUFFLE(3, 3, 3, 3));
    const __m128 back = _mm_permute_ps(passed, _MM_SHUFFLE(2, 2, 2, 2));
    const __m128 t = _mm_div_ps(front, _mm_sub_ps(front, back));
    const __m128 begin = _mm_load_ps(&naming.vertices[to >> 32].position.x);
    const __m128 end = _mm_load_ps(&naming.vertices[static_cast<std::uint32_t>(to)].position.x);
    _mm_storeu_ps(&naming.ends[i].x, _mm_add_ps(begin, _mm_mul_ps(t, _mm_sub_ps(end, begin))));
  }
}

LIMN_TARGET_AVX2 inline std::uint32_t equalKeysAvx2(const std::uint32_t* keys, std::uint32_t key) {
  const __m256i wanted = _mm256_set1_epi32(static_cast<int>(key));
  const auto same = [&](std::size_t i) LIMN_TARGET_AVX2 {
    return _mm256_cmpeq_epi32(
        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(keys + i)),
        wanted);
  };
  const __m256i low = _mm256_packs_epi32(same(0), same(8));
  const __m256i high = _mm256_packs_epi32(same(16), same(24));
  // Packing goes by half: words of four are in the order 0, 2, 4, 6, 1, 3, 5, 7.
  const __m256i order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
  const __m256i bytes = _mm256_permutevar8x32_epi32(_mm256_packs_epi16(low, high), order);
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(bytes));
}

LIMN_TARGET_AVX512 inline std::uint32_t equalKeysAvx512(
    const std::uint32_t* keys,
    std::uint32_t key) {
  const __m512i wanted = _mm512_set1_epi32(static_cast<int>(key));
  const std::uint32_t low = _mm512_cmpeq_epi32_mask(_mm512_loadu_si512(keys), wanted);
  const std::uint32_t high = _mm512_cmpeq_epi32_mask(_mm512_loadu_si512(keys + 16), wanted);
  return high << 16 | low;
}

LIMN_TARGET_AVX512 void joinAvx512(const Crossings& crossings, NearJoins& joins) {
  join(crossings, joins, equalKeysAvx512);
}

LIMN_TARGET_AVX2 void joinAvx2(const Crossings& crossings, NearJoins& joins) {
  join(crossings, joins, equalKeysAvx2);
}
#endif

}  // namespace

void nameCrossings(
    const SilhouetteField& field,
    const glm::vec4& eye,
    std::span<const FaceId> faces,
    VectorCode code,
    Crossings& out) {
  const std::size_t count = faces.size();
  out.passages.resize(count + 2 * kNear + 1);
  out.keys.resize(count + 2 * kNear + 1);
  std::fill_n(out.passages.begin(), kNear, kNoPassage);
  std::fill(out.passages.end() - kNear - 1, out.passages.end(), kNoPassage);
  out.ends.resize(count);
  const Naming naming = {
      field.vertices().data(),
      field.mesh().origins.data(),
      faces.data(),
      count,
      out.passages.data() + kNear,
      out.keys.data() + kNear,
      out.ends.data()};
#if LIMN_HAS_AVX2
  if (code != VectorCode::kPortable) {
    nameAvx2(naming, eye);
    return;
  }
#endif
  static_cast<void>(code);
  namePortable(naming, eye);
}

void joinNear(const Crossings& crossings, VectorCode code, NearJoins& joins) {
#if LIMN_HAS_AVX2
  if (code == VectorCode::kAvx512) {
    joinAvx512(crossings, joins);
    return;
  }
  if (code == VectorCode::kAvx2) {
    joinAvx2(crossings, joins);
    return;
  }
#endif
  static_cast<void>(code);
  join(crossings, joins, equalKeysPortable);
}

}  // namespace limn::chaining
