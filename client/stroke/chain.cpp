// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.3:
// chaining through half-edges, loops closed, directions made consistent.
// Deviations: direction is consistent by construction (front to the left), so nothing is flipped
// afterwards; where several silhouette edges meet, rotating through the front sector pairs them
// one to one. First every segment is named by what leads into it and what it leads to, each on its
// own, so that the memory accesses overlap and can be asked for ahead; a hash table then joins the
// names; only then are lines read off, in arrays that fit a near cache.
#include "client/stroke/chain.h"

#include "shared/silhouette/trace.h"

#include <algorithm>
#include <array>
#include <bit>

#if defined(__SSE2__)
#include <emmintrin.h>
#include <xmmintrin.h>
#endif

namespace limn {
namespace {

std::uint64_t hashOf(std::uint64_t name) {
  return name * 0x9E3779B97F4A7C15ULL;
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
    const glm::vec4* planes,
    const std::uint32_t* corners,
    const glm::vec4& eye,
    std::array<float, 4>& values) {
#if defined(__SSE2__)
  const __m128 e = _mm_loadu_ps(&eye.x);
  __m128 x = _mm_mul_ps(_mm_loadu_ps(&planes[corners[0]].x), e);
  __m128 y = _mm_mul_ps(_mm_loadu_ps(&planes[corners[1]].x), e);
  __m128 z = _mm_mul_ps(_mm_loadu_ps(&planes[corners[2]].x), e);
  __m128 w = _mm_setzero_ps();
  _MM_TRANSPOSE4_PS(x, y, z, w);
  const __m128 sums = _mm_add_ps(_mm_add_ps(_mm_add_ps(x, y), z), w);
  _mm_store_ps(values.data(), sums);
  return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmpgt_ps(sums, _mm_setzero_ps())));
#else
  std::uint32_t mask = 0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    values[k] = SilhouetteField::valueAt(planes[corners[k]], eye);
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
    const auto pointOf = [&](std::uint32_t v) { return glm::vec3(field.positions()[v]); };
    readLines(
        edges.size(),
        [&](std::uint32_t i, std::uint32_t) { return pointOf(mesh.origin(edges[i])); },
        [&](std::uint32_t i) { return pointOf(mesh.target(edges[i])); });
    for (std::uint32_t& segment : lines_.faces) {
      lines_.halfEdges[static_cast<std::size_t>(&segment - lines_.faces.data())] =
          segment == kNone ? kNone : edges[segment];
      if (segment != kNone) segment = HalfEdgeMesh::face(edges[segment]);
    }
    return lines_;
  }
  const std::span<const FaceId> faces = found.faces;
  const glm::vec4 eye = field.eyeOf(view);
  linkFaces(field, eye, faces);
  SmoothWalk walk(field, eye);
  readLines(
      faces.size(),
      [&](std::uint32_t i, std::uint32_t previous) {
        // A segment starts where the one before ends, to the last bit.
        if (previous != kNone) return ends_[previous];
        return walk.start(faces[i]) ? walk.entryPoint() : glm::vec3(0.0F);
      },
      [&](std::uint32_t i) { return ends_[i]; });
  std::fill(lines_.halfEdges.begin(), lines_.halfEdges.end(), kNone);
  for (std::uint32_t& segment : lines_.faces) {
    if (segment != kNone) segment = faces[segment];
  }
  return lines_;
}

// Reads lines off the successors: open ones from their first segments, then loops. Leaves the
// segments' numbers in lines_.faces. startOf(i, previous): previous is kNone for an open line's
// first segment. endOf(last): of an open line.
template <class PointOf, class EndOf>
void SilhouetteChainer::readLines(std::size_t count, PointOf startOf, EndOf endOf) {
  const auto openLines =
      static_cast<std::size_t>(std::count(isContinued_.begin(), isContinued_.end(), 0));
  lines_.lines.clear();
  // Never cleared: what is there from the last frame is overwritten.
  lines_.points.resize(count + openLines);
  lines_.halfEdges.resize(count + openLines);
  lines_.faces.resize(count + openLines);
  isUsed_.assign(count, 0);
  std::uint32_t out = 0;
  const auto add = [&](const glm::vec3& point, std::uint32_t segment) {
    lines_.points[out] = point;
    lines_.faces[out] = segment;
    ++out;
  };
  for (std::uint32_t first = 0; first < count; ++first) {
    if (isContinued_[first] != 0) continue;
    PolylineSet::Line line;
    line.begin = out;
    std::uint32_t last = kNone;
    for (std::uint32_t i = first; i != kNone; i = next_[i]) {
      isUsed_[i] = 1;
      add(startOf(i, last), i);
      last = i;
    }
    add(endOf(last), kNone);
    line.end = out;
    lines_.lines.push_back(line);
  }
  for (std::uint32_t first = 0; first < count; ++first) {
    if (isUsed_[first] != 0) continue;
    PolylineSet::Line line;
    line.closed = true;
    line.begin = out;
    std::uint32_t last = first;
    ++out;  // filled when the loop has come round
    for (std::uint32_t i = next_[first]; i != first; i = next_[i]) {
      isUsed_[i] = 1;
      add(startOf(i, last), i);
      last = i;
    }
    isUsed_[first] = 1;
    lines_.points[line.begin] = startOf(first, last);
    lines_.faces[line.begin] = first;
    line.end = out;
    lines_.lines.push_back(line);
  }
}

// Makes the table of the segments by names_.
void SilhouetteChainer::enterNames(std::size_t count) {
  const std::size_t size = std::bit_ceil(std::max<std::size_t>(3 * count, 16));
  tableShift_ = 64 - std::countr_zero(size);
  table_.assign(size, kNone);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::size_t at = hashOf(names_[i]) >> tableShift_;
    while (table_[at] != kNone)
      at = (at + 1) & (size - 1);
    table_[at] = i;
  }
  next_.assign(count, kNone);
  isContinued_.assign(count, 0);
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
  enterNames(count);
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
    if (only == kNone || isContinued_[only] != 0) continue;
    next_[i] = only;
    isContinued_[only] = 1;
  }
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
  const HalfEdgeMesh& mesh = field.mesh();
  const glm::vec4* planes = field.planes().data();
  const glm::ivec3* positions = field.positions().data();
  const std::uint32_t* origins = mesh.origins.data();
  const std::size_t count = faces.size();
  constexpr std::size_t kFar = 32;   // faces ahead whose corners are asked for
  constexpr std::size_t kNear = 16;  // faces ahead whose corners' planes and positions are
  names_.resize(count);
  nextNames_.resize(count);
  ends_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i + kFar < count) __builtin_prefetch(&origins[3 * faces[i + kFar]]);
    if (i + kNear < count) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t v = origins[3 * faces[i + kNear] + k];
        __builtin_prefetch(&planes[v]);
        __builtin_prefetch(&positions[v]);
      }
    }
    const std::uint32_t* corners = &origins[3 * faces[i]];
    alignas(16) std::array<float, 4> values;
    const std::uint32_t mask = sidesOf(planes, corners, eye, values);
    const Way way = kWays[mask];
    names_[i] = crossingName(corners[way.enterFront], corners[way.enterBack]);
    const std::uint32_t front = corners[way.leaveFront];
    const std::uint32_t back = corners[way.leaveBack];
    nextNames_[i] = crossingName(front, back);
    // SmoothWalk::exitPoint, to the last bit.
    const float t = values[way.leaveFront] / (values[way.leaveFront] - values[way.leaveBack]);
    const glm::ivec3& from = positions[front];
    ends_[i] = glm::vec3(from) + t * glm::vec3(positions[back] - from);
  }
  enterNames(count);
  const std::size_t tableMask = table_.size() - 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::size_t at = hashOf(nextNames_[i]) >> tableShift_; table_[at] != kNone;
         at = (at + 1) & tableMask) {
      if (names_[table_[at]] != nextNames_[i]) continue;
      next_[i] = table_[at];
      isContinued_[table_[at]] = 1;
      break;
    }
  }
}

}  // namespace limn
