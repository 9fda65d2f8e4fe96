// SPDX-License-Identifier: Apache-2.0
// Based on: the two-pass brute force of P. V. Sander et al., "Silhouette Clipping", SIGGRAPH 2000,
// section 5 (facing first, edges after).
// Deviations: facing is one bit a site, so that the table of a 70k-face mesh fits a first-level
// cache; the second pass walks half-edges in file order, eight faces at a time, skips eights
// without a front face, and so needs no edge list. With AVX-512, sixteen faces at a time.
#include "shared/silhouette/brute_force.h"

#include "shared/core/simd.h"

#include <bit>
#include <cstring>

namespace limn {
namespace {

constexpr std::size_t kLanes = 8;
constexpr std::size_t kHalfEdgesPerBlock = 3 * kLanes;
constexpr std::size_t kMostLanes = 16;

using Planes = std::array<std::vector<float>, 4>;

// Bit i of the byte at bit 3i of the result, and at the two bits above.
constexpr std::array<std::uint32_t, 256> kSpread = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    for (std::uint32_t i = 0; i < 8; ++i) {
      if (byte >> i & 1) table[byte] |= 7U << (3 * i);
    }
  }
  return table;
}();

std::uint32_t bitAt(const std::uint8_t* bits, std::uint32_t i) {
  return static_cast<std::uint32_t>(bits[i >> 3] >> (i & 7)) & 1U;
}

// Of 24 half-edges, those whose partner is front.
std::uint32_t partnersInFrontPortable(const std::uint32_t* partners, const std::uint8_t* front) {
  std::uint32_t mask = 0;
  for (std::uint32_t i = 0; i < kHalfEdgesPerBlock; ++i)
    mask |= bitAt(front, partners[i]) << i;
  return mask;
}

void classifyPortable(const Planes& planes, const glm::vec4& eye, std::uint8_t* front) {
  const std::size_t blocks = planes[0].size() / kLanes;
  for (std::size_t b = 0; b < blocks; ++b) {
    std::uint32_t byte = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::size_t s = b * kLanes + i;
      const float value =
          SilhouetteField::valueAt({planes[0][s], planes[1][s], planes[2][s], planes[3][s]}, eye);
      byte |= static_cast<std::uint32_t>(value > 0.0F) << i;
    }
    front[b] = static_cast<std::uint8_t>(byte);
  }
}

#if LIMN_HAS_AVX2
LIMN_TARGET_AVX2 inline std::uint32_t partnersInFrontAvx2(
    const std::uint32_t* partners,
    const std::uint8_t* front) {
  const __m256i low5 = _mm256_set1_epi32(31);
  std::uint32_t mask = 0;
  for (int j = 0; j < 3; ++j) {
    const __m256i index = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(partners + 8 * j));
    const __m256i word =
        _mm256_i32gather_epi32(reinterpret_cast<const int*>(front), _mm256_srli_epi32(index, 5), 4);
    // The wanted bit becomes the sign bit.
    const __m256i sign =
        _mm256_sllv_epi32(word, _mm256_sub_epi32(low5, _mm256_and_si256(index, low5)));
    mask |= static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(sign))) << (8 * j);
  }
  return mask;
}

LIMN_TARGET_AVX2 void
classifyAvx2(const Planes& planes, const glm::vec4& eye, std::uint8_t* front) {
  const std::size_t blocks = planes[0].size() / kLanes;
  const __m256 ex = _mm256_set1_ps(eye.x);
  const __m256 ey = _mm256_set1_ps(eye.y);
  const __m256 ez = _mm256_set1_ps(eye.z);
  const __m256 ew = _mm256_set1_ps(eye.w);
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t s = b * kLanes;
    __m256 value = _mm256_mul_ps(_mm256_loadu_ps(&planes[0][s]), ex);
    value = _mm256_add_ps(value, _mm256_mul_ps(_mm256_loadu_ps(&planes[1][s]), ey));
    value = _mm256_add_ps(value, _mm256_mul_ps(_mm256_loadu_ps(&planes[2][s]), ez));
    value = _mm256_add_ps(value, _mm256_mul_ps(_mm256_loadu_ps(&planes[3][s]), ew));
    const __m256 positive = _mm256_cmp_ps(value, _mm256_setzero_ps(), _CMP_GT_OQ);
    front[b] = static_cast<std::uint8_t>(_mm256_movemask_ps(positive));
  }
}
#endif

#if LIMN_HAS_AVX2
LIMN_TARGET_AVX512 inline std::uint64_t partnersInFrontAvx512(
    const std::uint32_t* partners,
    const std::uint8_t* front) {
  std::uint64_t mask = 0;
  for (int j = 0; j < 3; ++j) {
    const __m512i index = _mm512_loadu_si512(partners + 16 * j);
    const __m512i word = _mm512_i32gather_epi32(_mm512_srli_epi32(index, 5), front, 4);
    // A shift takes the low five bits of its count.
    const __m512i bit = _mm512_rolv_epi32(_mm512_set1_epi32(1), index);
    mask |= std::uint64_t{_mm512_test_epi32_mask(word, bit)} << (16 * j);
  }
  return mask;
}

LIMN_TARGET_AVX512 void
classifyAvx512(const Planes& planes, const glm::vec4& eye, std::uint8_t* front) {
  const __m512 ex = _mm512_set1_ps(eye.x);
  const __m512 ey = _mm512_set1_ps(eye.y);
  const __m512 ez = _mm512_set1_ps(eye.z);
  const __m512 ew = _mm512_set1_ps(eye.w);
  for (std::size_t s = 0; s < planes[0].size(); s += kMostLanes) {
    __m512 value = _mm512_mul_ps(_mm512_loadu_ps(&planes[0][s]), ex);
    value = _mm512_add_ps(value, _mm512_mul_ps(_mm512_loadu_ps(&planes[1][s]), ey));
    value = _mm512_add_ps(value, _mm512_mul_ps(_mm512_loadu_ps(&planes[2][s]), ez));
    value = _mm512_add_ps(value, _mm512_mul_ps(_mm512_loadu_ps(&planes[3][s]), ew));
    const std::uint16_t bits = _mm512_cmp_ps_mask(value, _mm512_setzero_ps(), _CMP_GT_OQ);
    std::memcpy(front + s / kLanes, &bits, sizeof bits);
  }
}
#endif

// Front half-edges of 24 whose partner face is back. A border's partner is its own face.
inline void collectEdges(
    std::size_t block,
    std::uint32_t ownFront,
    std::uint32_t partnerFront,
    std::vector<HalfEdgeId>& out) {
  for (std::uint32_t hits = ownFront & ~partnerFront; hits != 0; hits &= hits - 1) {
    out.push_back(
        static_cast<HalfEdgeId>(block * kHalfEdgesPerBlock) +
        static_cast<std::uint32_t>(std::countr_zero(hits)));
  }
}

// Faces of eight whose three corners (bits 3i … 3i + 2) differ.
inline void collectFaces(std::size_t block, std::uint32_t cornersFront, std::vector<FaceId>& out) {
  constexpr std::uint32_t kFirstCorners = 0x249249;
  const std::uint32_t differs = cornersFront ^ (cornersFront >> 1);
  for (std::uint32_t hits = (differs | differs >> 1) & kFirstCorners; hits != 0; hits &= hits - 1) {
    out.push_back(
        static_cast<FaceId>(block * kLanes) +
        static_cast<std::uint32_t>(std::countr_zero(hits)) / 3);
  }
}

// The second pass. partnersInFront: of 24 half-edges, those whose partner is front.
template <class PartnersInFront>
inline __attribute__((always_inline)) void search(
    SilhouetteKind kind,
    std::span<const std::uint32_t> partners,
    const std::uint8_t* front,
    SilhouetteResult& result,
    PartnersInFront partnersInFront) {
  const std::size_t blocks = partners.size() / kHalfEdgesPerBlock;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::uint32_t* p = partners.data() + b * kHalfEdgesPerBlock;
    if (kind == SilhouetteKind::kSmooth) {
      collectFaces(b, partnersInFront(p, front), result.faces);
    } else if (front[b] != 0) {
      collectEdges(b, kSpread[front[b]], partnersInFront(p, front), result.edges);
    }
  }
}

void searchPortable(
    SilhouetteKind kind,
    std::span<const std::uint32_t> partners,
    const std::uint8_t* front,
    SilhouetteResult& result) {
  search(kind, partners, front, result, partnersInFrontPortable);
}

#if LIMN_HAS_AVX2
// Two blocks at a time.
LIMN_TARGET_AVX512 void searchAvx512(
    SilhouetteKind kind,
    std::span<const std::uint32_t> partners,
    const std::uint8_t* front,
    SilhouetteResult& result) {
  constexpr std::uint32_t kBlock = (1U << kHalfEdgesPerBlock) - 1;
  for (std::size_t b = 0; b < partners.size() / kHalfEdgesPerBlock; b += 2) {
    const std::uint32_t* p = partners.data() + b * kHalfEdgesPerBlock;
    if (kind == SilhouetteKind::kSmooth) {
      const std::uint64_t mask = partnersInFrontAvx512(p, front);
      collectFaces(b, static_cast<std::uint32_t>(mask) & kBlock, result.faces);
      collectFaces(b + 1, static_cast<std::uint32_t>(mask >> kHalfEdgesPerBlock), result.faces);
    } else if ((front[b] | front[b + 1]) != 0) {
      const std::uint64_t mask = partnersInFrontAvx512(p, front);
      collectEdges(b, kSpread[front[b]], static_cast<std::uint32_t>(mask) & kBlock, result.edges);
      collectEdges(
          b + 1,
          kSpread[front[b + 1]],
          static_cast<std::uint32_t>(mask >> kHalfEdgesPerBlock),
          result.edges);
    }
  }
}

LIMN_TARGET_AVX2 void searchAvx2(
    SilhouetteKind kind,
    std::span<const std::uint32_t> partners,
    const std::uint8_t* front,
    SilhouetteResult& result) {
  search(kind, partners, front, result, partnersInFrontAvx2);
}
#endif

std::size_t roundUp(std::size_t n, std::size_t unit) {
  return (n + unit - 1) / unit * unit;
}

}  // namespace

BruteForceDetector::BruteForceDetector(const SilhouetteField& field, const DetectorOptions& options)
    : field_(&field),
      vectorCode_(chooseVectorCode(options.vectorCode)) {
  const HalfEdgeMesh& mesh = field.mesh();
  const std::size_t sites = roundUp(field.siteCount(), kMostLanes);
  for (std::size_t k = 0; k < 4; ++k) {
    planes_[k].assign(sites, 0.0F);  // padding is back everywhere
    for (std::uint32_t s = 0; s < field.siteCount(); ++s)
      planes_[k][s] = field.plane(s)[static_cast<int>(k)];
  }
  front_.assign(sites / kLanes + 4, 0);  // words are read whole
  // A padding face compares its site 0 thrice, or, being back itself, is never looked at.
  partners_.assign(roundUp(mesh.origins.size(), 3 * kMostLanes), 0);
  for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
    if (field.kind() == SilhouetteKind::kSmooth) {
      partners_[h] = mesh.origins[h];
    } else {
      partners_[h] = HalfEdgeMesh::face(mesh.twins[h] == kNone ? h : mesh.twins[h]);
    }
  }
}

const SilhouetteResult& BruteForceDetector::detect(const SilhouetteView& view) {
  const glm::vec4 eye = field_->eyeOf(view);
  result_.kind = field_->kind();
  result_.edges.clear();
  result_.faces.clear();
#if LIMN_HAS_AVX2
  if (vectorCode_ == VectorCode::kAvx512) {
    classifyAvx512(planes_, eye, front_.data());
    searchAvx512(field_->kind(), partners_, front_.data(), result_);
  } else if (vectorCode_ == VectorCode::kAvx2) {
    classifyAvx2(planes_, eye, front_.data());
    searchAvx2(field_->kind(), partners_, front_.data(), result_);
  } else
#endif
  {
    classifyPortable(planes_, eye, front_.data());
    searchPortable(field_->kind(), partners_, front_.data(), result_);
  }
  result_.stats = {};
  result_.stats.facesVisited = field_->mesh().faceCount();
  result_.stats.sitesTested = field_->siteCount();
  result_.stats.segments = static_cast<std::uint32_t>(result_.edges.size() + result_.faces.size());
  return result_;
}

std::size_t BruteForceDetector::memoryBytes() const {
  return 4 * planes_[0].size() * sizeof(float) + partners_.size() * sizeof(std::uint32_t) +
         front_.size() + result_.edges.capacity() * sizeof(HalfEdgeId) +
         result_.faces.capacity() * sizeof(FaceId);
}

}  // namespace limn
