// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.3:
// chaining through half-edges, loops closed, directions made consistent.
// Deviations: direction is consistent by construction (front to the left), so nothing is flipped
// afterwards; where several silhouette edges meet, rotating through the front sector pairs them
// one to one. First every segment is named by what leads into it and what it leads to, each on its
// own, so that the memory accesses overlap and can be asked for ahead. Detectors find neighbours
// together, so most names are joined with one a few places on; a hash table joins the rest. Only
// then are lines read off, in arrays that fit a near cache.
#include "client/stroke/chain/chain.h"

#include "shared/core/vector_code.h"
#include "shared/silhouette/trace.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace limn {
namespace {

using chaining::hashOf;
using chaining::kNear;

// A segment whose line has been read off.
constexpr std::uint32_t kRead = kNone - 1;

}  // namespace

SilhouetteChainer::SilhouetteChainer(VectorCode most) : vectorCode_(chooseVectorCode(most)) {}

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
  const glm::vec4* ends = crossings_.ends.data();
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
  joins_.next.assign(count, kNone);
  joins_.isContinued.assign(count + 2 * kNear + 1, 0);
  openLines_ = count;
}

// Reads lines off the successors: open ones from their first segments, then loops.
// put(i, previous, out): segment i starts at point `out`; previous: the one before, kNone for an
// open line's first. putEnd(i, out): so ends segment i, an open line's last.
template <class Put, class PutEnd>
void SilhouetteChainer::readLines(Put put, PutEnd putEnd) {
  std::uint32_t* next = joins_.next.data();
  const auto count = static_cast<std::uint32_t>(joins_.next.size());
  lines_.lines.clear();
  std::uint32_t out = 0;
  for (std::uint32_t first = 0; openLines_ > 0 && first < count; ++first) {
    if (joins_.isContinued[kNear + first] != 0) continue;
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
  for (std::uint32_t first = 0;; ++first) {
    while (first < count && next[first] == kRead)
      ++first;
    if (first == count) break;
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
  lines_.points.resize(joins_.next.size() + openLines_);
  lines_.faces.resize(joins_.next.size() + openLines_);
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
  passages_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i + kAhead < count) __builtin_prefetch(&mesh.origins[edges[i + kAhead]]);
    passages_[i] = {mesh.origin(edges[i]), mesh.target(edges[i])};
    __builtin_prefetch(&field.positions()[passages_[i].from]);  // wanted when lines are read off
  }
  clearTable(count);
  for (std::uint32_t i = 0; i < count; ++i)
    enter(passages_[i].from, i);
  begin(count);
  const std::size_t mask = table_.size() - 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    // Where one edge alone goes on, and there is no border to stop at, it is the one.
    std::uint32_t only = kNone;
    std::uint32_t goingOn = 0;
    for (std::size_t at = hashOf(passages_[i].to) >> tableShift_; table_[at] != kNone;
         at = (at + 1) & mask) {
      if (passages_[table_[at]].from != passages_[i].to) continue;
      only = table_[at];
      ++goingOn;
    }
    if (goingOn == 0) continue;
    if (goingOn > 1 || field.hasBorder()) only = successorOf(mesh, edges, edges[i]);
    // Where not every silhouette was found, two may want the same one.
    if (only == kNone || joins_.isContinued[kNear + only] != 0) continue;
    joins_.next[i] = only;
    joins_.isContinued[kNear + only] = 1;
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
  chaining::nameCrossings(field, eye, faces, vectorCode_, crossings_);
  begin(faces.size());
  chaining::joinNear(crossings_, vectorCode_, joins_);
  linkRest();
  makeRoom();
}

// Joins the others by their names.
void SilhouetteChainer::linkRest() {
  const std::size_t count = crossings_.ends.size();
  const chaining::Passage* passages = crossings_.passages.data() + kNear;
  std::uint8_t* isContinued = joins_.isContinued.data() + kNear;
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
    enter(passages[i].from, i);
  const std::size_t mask = table_.size() - 1;
  for (const std::uint32_t i : joins_.unjoined) {
    for (std::size_t at = hashOf(passages[i].to) >> tableShift_; table_[at] != kNone;
         at = (at + 1) & mask) {
      if (passages[table_[at]].from != passages[i].to) continue;
      joins_.next[i] = table_[at];
      isContinued[table_[at]] = 1;
      --openLines_;
      break;
    }
  }
}

}  // namespace limn
