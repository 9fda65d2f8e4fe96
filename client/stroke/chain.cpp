// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.3:
// chaining through half-edges, loops closed, directions made consistent.
// Deviations: direction is consistent by construction (front to the left), so nothing is flipped
// afterwards; where several silhouette edges meet, rotating through the front sector pairs them
// one to one. First every segment is named by what leads into it and what it leads to, each on its
// own, so that the memory accesses overlap and can be asked for ahead. Detectors find neighbours
// together, so most names are joined with one a few places on; a hash table joins the rest. Only
// then are lines read off, in arrays that fit a near cache.
#include "client/stroke/chain.h"

#include "shared/silhouette/trace.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#include <xmmintrin.h>
#endif

namespace limn {
namespace {

std::uint64_t hashOf(std::uint64_t name) {
  return name * 0x9E3779B97F4A7C15ULL;
}

// The half of a hash that names are compared by at first.
std::uint32_t keyOf(std::uint64_t name) {
  return static_cast<std::uint32_t>(hashOf(name) >> 32);
}

// No segment's.
constexpr std::uint64_t kNoName = ~std::uint64_t{0};

// A segment whose line has been read off.
constexpr std::uint32_t kRead = kNone - 1;

// How many places before and after its own a segment's successor is looked for before the table.
constexpr std::size_t kNear = 16;

// Of the 2 kNear keys from `keys`, those that are `key`.
std::uint64_t equalKeys(const std::uint32_t* keys, std::uint32_t key) {
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
  return std::uint64_t{sixteen(16)} << 16 | sixteen(0);
#else
  std::uint64_t mask = 0;
  for (std::size_t i = 0; i < 2 * kNear; ++i)
    mask |= std::uint64_t{keys[i] == key} << i;
  return mask;
#endif
}

// An edge that the smooth silhouette crosses, by its front and its back vertex.
std::uint64_t crossingName(std::uint32_t front, std::uint32_t back) {
  return std::uint64_t{front} << 32 | back;
}

// Through which edges the silhouette passes a face, as corners: it enters from a front to a back
// corner (in the face's order) and leaves the other way round.
struct Way {
  std::uint8_t enterFront, enterBack, leaveFront, leaveBack;
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
    ways[mask] = isFront ? Way{alone, next, alone, before} : Way{before, alone, next, alone};
  }
  return ways;
}();

// The values of a face's corners, SilhouetteField::valueAt's to the last bit, and their sides.
inline std::uint32_t sidesOf(
    const VertexSite* vertices,
    const std::uint32_t* corners,
    const glm::vec4& eye,
    std::array<float, 4>& values) {
#if defined(__SSE2__)
  const __m128 e = _mm_loadu_ps(&eye.x);
  __m128 x = _mm_mul_ps(_mm_load_ps(&vertices[corners[0]].plane.x), e);
  __m128 y = _mm_mul_ps(_mm_load_ps(&vertices[corners[1]].plane.x), e);
  __m128 z = _mm_mul_ps(_mm_load_ps(&vertices[corners[2]].plane.x), e);
  __m128 w = _mm_setzero_ps();
  _MM_TRANSPOSE4_PS(x, y, z, w);
  const __m128 sums = _mm_add_ps(_mm_add_ps(_mm_add_ps(x, y), z), w);
  _mm_store_ps(values.data(), sums);
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmpgt_ps(sums, _mm_setzero_ps())));
#else
  std::uint32_t mask = 0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    values[k] = SilhouetteField::valueAt(vertices[corners[k]].plane, eye);
    mask |= static_cast<std::uint32_t>(values[k] > 0.0F) << k;
  }
  return mask;
#endif
}

}  // namespace

const PolylineSet& SilhouetteChainer::chain(
    const SilhouetteField& field,
    const SilhouetteView& view,
    const SilhouetteResult& found) {
  const HalfEdgeMesh& mesh = field.mesh();
  if (found.kind == SilhouetteKind::kEdges) {
    const std::span<const HalfEdgeId> edges = found.edges;
    linkEdges(field, edges);
    lines_.halfEdges.resize(lines_.points.size());
    const auto pointOf = [&](std::uint32_t v) { return glm::vec3(field.positions()[v]); };
    readLines(
        [&](std::uint32_t i, std::uint32_t, std::uint32_t out) {
          lines_.points[out] = pointOf(mesh.origin(edges[i]));
          lines_.halfEdges[out] = edges[i];
          lines_.faces[out] = HalfEdgeMesh::face(edges[i]);
        },
        [&](std::uint32_t i, std::uint32_t out) {
          lines_.points[out] = pointOf(mesh.target(edges[i]));
          lines_.halfEdges[out] = kNone;
        });
    return lines_;
  }
  const std::span<const FaceId> faces = found.faces;
  const glm::vec4 eye = field.eyeOf(view);
  linkFaces(field, eye, faces);
  // What earlier edges left there is the only thing to clear.
  if (hadEdges_) lines_.halfEdges.clear();
  lines_.halfEdges.resize(lines_.points.size(), kNone);
  hadEdges_ = false;
  SmoothWalk walk(field, eye);
  const FaceId* faceOf = faces.data();
  const glm::vec4* ends = ends_.data();
  glm::vec3* points = lines_.points.data();
  FaceId* facesOut = lines_.faces.data();
  readLines(
      [&](std::uint32_t i, std::uint32_t previous, std::uint32_t out) {
        facesOut[out] = faceOf[i];
        // A segment starts where the one before ends, to the last bit.
        if (previous != kNone) [[likely]] {
          points[out] = ends[previous];
        } else {
          points[out] = walk.start(faces[i]) ? walk.entryPoint() : glm::vec3(0.0F);
        }
      },
      [&](std::uint32_t i, std::uint32_t out) { points[out] = ends[i]; });
  return lines_;
}

// Nothing is chained yet; lines_ has room for `count` segments.
void SilhouetteChainer::begin(std::size_t count) {
  next_.assign(count, kNone);
  isContinued_.assign(count + 2 * kNear + 1, 0);
  openLines_ = count;
}

// Reads lines off the successors: open ones from their first segments, then loops.
// put(i, previous, out): segment i starts at point `out`; previous: the one before, kNone for an
// open line's first. putEnd(i, out): so ends segment i, an open line's last.
template <class Put, class PutEnd>
void SilhouetteChainer::readLines(Put put, PutEnd putEnd) {
  std::uint32_t* next = next_.data();
  const auto count = static_cast<std::uint32_t>(next_.size());
  lines_.lines.clear();
  std::uint32_t out = 0;
  for (std::uint32_t first = 0; openLines_ > 0 && first < count; ++first) {
    if (isContinued_[kNear + first] != 0) continue;
    --openLines_;
    PolylineSet::Line line;
    line.begin = out;
    std::uint32_t last = kNone;
    for (std::uint32_t i = first; i != kNone;) {
      put(i, last, out++);
      last = i;
      i = std::exchange(next[i], kRead);
    }
    lines_.faces[out] = kNone;
    putEnd(last, out++);
    line.end = out;
    lines_.lines.push_back(line);
  }
  for (std::uint32_t first = 0; first < count; ++first) {
    if (next[first] == kRead) continue;
    PolylineSet::Line line;
    line.closed = true;
    line.begin = out++;  // filled when the loop has come round
    std::uint32_t last = first;
    for (std::uint32_t i = std::exchange(next[first], kRead); i != first;) {
      put(i, last, out++);
      last = i;
      i = std::exchange(next[i], kRead);
    }
    put(first, last, line.begin);
    line.end = out;
    lines_.lines.push_back(line);
  }
}

// One point a segment and one more an open line; what is there from the last frame is overwritten.
void SilhouetteChainer::makeRoom() {
  lines_.points.resize(next_.size() + openLines_);
  lines_.faces.resize(next_.size() + openLines_);
}

// An empty table for so many names.
void SilhouetteChainer::clearTable(std::size_t names) {
  const std::size_t size = std::bit_ceil(std::max<std::size_t>(3 * names, 16));
  tableShift_ = 64 - std::countr_zero(size);
  table_.assign(size, kNone);
}

void SilhouetteChainer::enter(std::uint64_t name, std::uint32_t segment) {
  const std::size_t mask = table_.size() - 1;
  std::size_t at = hashOf(name) >> tableShift_;
  while (table_[at] != kNone)
    at = (at + 1) & mask;
  table_[at] = segment;
}

void SilhouetteChainer::linkEdges(const SilhouetteField& field, std::span<const HalfEdgeId> edges) {
  const HalfEdgeMesh& mesh = field.mesh();
  const std::size_t count = edges.size();
  constexpr std::size_t kAhead = 16;
  names_.resize(count);
  nextNames_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i + kAhead < count) __builtin_prefetch(&mesh.origins[edges[i + kAhead]]);
    names_[i] = mesh.origin(edges[i]);
    nextNames_[i] = mesh.target(edges[i]);
    __builtin_prefetch(&field.positions()[names_[i]]);  // wanted when lines are read off
  }
  clearTable(count);
  for (std::uint32_t i = 0; i < count; ++i)
    enter(names_[i], i);
  begin(count);
  const std::size_t mask = table_.size() - 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    // Where one edge alone goes on, and there is no border to stop at, it is the one.
    std::uint32_t only = kNone;
    std::uint32_t goingOn = 0;
    for (std::size_t at = hashOf(nextNames_[i]) >> tableShift_; table_[at] != kNone;
         at = (at + 1) & mask) {
      if (names_[table_[at]] != nextNames_[i]) continue;
      only = table_[at];
      ++goingOn;
    }
    if (goingOn == 0) continue;
    if (goingOn > 1 || field.hasBorder()) only = successorOf(mesh, edges, edges[i]);
    // Where not every silhouette was found, two may want the same one.
    if (only == kNone || isContinued_[kNear + only] != 0) continue;
    next_[i] = only;
    isContinued_[kNear + only] = 1;
    --openLines_;
  }
  makeRoom();
  hadEdges_ = true;
}

// The segment that goes on from silhouette edge h, or kNone: clockwise round the target through
// the front sector. Where not every silhouette was found, the turn may come round to the edge's own
// back face.
std::uint32_t SilhouetteChainer::successorOf(
    const HalfEdgeMesh& mesh,
    std::span<const HalfEdgeId> edges,
    HalfEdgeId h) const {
  const std::size_t mask = table_.size() - 1;
  const std::uint64_t name = mesh.target(h);
  const HalfEdgeId last = mesh.twins[h];
  for (HalfEdgeId g = HalfEdgeMesh::next(h); g != kNone && g != last; g = mesh.rotateCw(g)) {
    for (std::size_t at = hashOf(name) >> tableShift_; table_[at] != kNone; at = (at + 1) & mask) {
      if (edges[table_[at]] == g) return table_[at];
    }
  }
  return kNone;
}

void SilhouetteChainer::linkFaces(
    const SilhouetteField& field,
    const glm::vec4& eye,
    std::span<const FaceId> faces) {
  nameCrossings(field, eye, faces);
  begin(faces.size());
  linkNeighbours();
  linkRest();
  makeRoom();
}

// What leads into each face and what it leads to, and where it is left.
void SilhouetteChainer::nameCrossings(
    const SilhouetteField& field,
    const glm::vec4& eye,
    std::span<const FaceId> faces) {
  const VertexSite* vertices = field.vertices().data();
  const std::uint32_t* origins = field.mesh().origins.data();
  const std::size_t count = faces.size();
  constexpr std::size_t kFarAhead = 64;   // faces whose corners are asked for
  constexpr std::size_t kNearAhead = 24;  // faces whose corners' vertices are
  // With a margin on both sides.
  names_.resize(count + 2 * kNear + 1);
  keys_.resize(count + 2 * kNear + 1);
  std::fill_n(names_.begin(), kNear, kNoName);
  std::fill(names_.end() - kNear - 1, names_.end(), kNoName);
  nextNames_.resize(count);
  ends_.resize(count);
  std::uint64_t* names = names_.data() + kNear;
  std::uint64_t* nextNames = nextNames_.data();
  std::uint32_t* keys = keys_.data() + kNear;
  glm::vec4* ends = ends_.data();
  for (std::size_t i = 0; i < count; ++i) {
    __builtin_prefetch(&origins[3 * faces[std::min(i + kFarAhead, count - 1)]]);
    if (i + kNearAhead < count) {
      const std::uint32_t* ahead = &origins[3 * faces[i + kNearAhead]];
      for (std::uint32_t k = 0; k < 3; ++k)
        __builtin_prefetch(&vertices[ahead[k]]);
    }
    const std::uint32_t* corners = &origins[3 * faces[i]];
    alignas(16) std::array<float, 4> values;
    const Way way = kWays[sidesOf(vertices, corners, eye, values)];
    names[i] = crossingName(corners[way.enterFront], corners[way.enterBack]);
    keys[i] = keyOf(names[i]);
    const std::uint32_t front = corners[way.leaveFront];
    const std::uint32_t back = corners[way.leaveBack];
    nextNames[i] = crossingName(front, back);
    // SmoothWalk::exitPoint, to the last bit: positions are exact.
    const float t = values[way.leaveFront] / (values[way.leaveFront] - values[way.leaveBack]);
    const glm::vec4& from = vertices[front].position;
    ends[i] = from + t * (vertices[back].position - from);
  }
}

// Joins segments that were found a few places from one another. Which those are cannot be foretold,
// so it is no branch.
void SilhouetteChainer::linkNeighbours() {
  const std::size_t count = nextNames_.size();
  const std::uint64_t* names = names_.data() + kNear;
  const std::uint64_t* nextNames = nextNames_.data();
  const std::uint32_t* keys = keys_.data();
  std::uint32_t* next = next_.data();
  std::uint8_t* isContinued = isContinued_.data();
  unjoined_.resize(count);
  std::uint32_t* unjoined = unjoined_.data();
  std::size_t left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t same = equalKeys(keys + i, keyOf(nextNames[i]));
    // The first of them, else the last of the margin. Where keys are alike by chance, the table
    // finds the right one.
    const auto place =
        static_cast<std::size_t>(std::countr_zero(same | std::uint64_t{1} << (2 * kNear)));
    const bool isSame = names[i + place - kNear] == nextNames[i];
    next[i] = isSame ? static_cast<std::uint32_t>(i + place - kNear) : kNone;
    isContinued[i + place] |= static_cast<std::uint8_t>(isSame);
    unjoined[left] = static_cast<std::uint32_t>(i);
    left += isSame ? 0 : 1;
  }
  unjoined_.resize(left);
}

// Joins the others by their names.
void SilhouetteChainer::linkRest() {
  const std::size_t count = nextNames_.size();
  const std::uint64_t* names = names_.data() + kNear;
  std::uint8_t* isContinued = isContinued_.data() + kNear;
  // In these two, no branch either.
  begins_.resize(count + 1);
  std::size_t begins = 0;
  for (std::size_t i = 0; i < count; ++i) {
    begins_[begins] = static_cast<std::uint32_t>(i);
    begins += isContinued[i] == 0 ? 1 : 0;
  }
  openLines_ = begins;
  begins_.resize(begins);
  clearTable(begins);
  for (const std::uint32_t i : begins_)
    enter(names[i], i);
  const std::size_t mask = table_.size() - 1;
  for (const std::uint32_t i : unjoined_) {
    for (std::size_t at = hashOf(nextNames_[i]) >> tableShift_; table_[at] != kNone;
         at = (at + 1) & mask) {
      if (names[table_[at]] != nextNames_[i]) continue;
      next_[i] = table_[at];
      isContinued[table_[at]] = 1;
      --openLines_;
      break;
    }
  }
}

}  // namespace limn
