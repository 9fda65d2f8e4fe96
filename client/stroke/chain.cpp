// SPDX-License-Identifier: Apache-2.0
// Based on: M. Mohr, "Silhouette Rendering on Mobile Devices" (thesis, Graz 2013), section 3.3:
// chaining through half-edges, loops closed, directions made consistent.
// Deviations: direction is consistent by construction (front to the left), so nothing is flipped
// afterwards; where several silhouette edges meet, rotating through the front sector pairs them
// one to one. First every segment finds its successor, each on its own, so that the memory accesses
// overlap; only then are lines read off, in arrays that fit the nearest cache.
#include "client/stroke/chain.h"

#include "shared/silhouette/trace.h"

#include <algorithm>

namespace limn {
namespace {

void append(PolylineSet& set, const glm::vec3& point, HalfEdgeId h, FaceId f) {
  set.points.push_back(point);
  set.halfEdges.push_back(h);
  set.faces.push_back(f);
}

// Reads lines off the successors: open ones from their first segments, then loops.
// emit(i, previous) is called for each segment (previous: kNone for a line's first), emitEnd(last)
// after those of an open line.
template <class Emit, class EmitEnd>
void readLines(
    std::span<const std::uint32_t> next,
    std::span<const std::uint8_t> isContinued,
    std::vector<std::uint8_t>& isUsed,
    PolylineSet& set,
    Emit emit,
    EmitEnd emitEnd) {
  const auto count = static_cast<std::uint32_t>(next.size());
  isUsed.assign(count, 0);
  const auto readFrom = [&](std::uint32_t first) {
    PolylineSet::Line line;
    line.begin = static_cast<std::uint32_t>(set.points.size());
    std::uint32_t last = kNone;
    std::uint32_t i = first;
    for (; i != kNone && isUsed[i] == 0; i = next[i]) {
      isUsed[i] = 1;
      emit(i, last);
      last = i;
    }
    line.closed = i == first;
    if (!line.closed) emitEnd(last);
    line.end = static_cast<std::uint32_t>(set.points.size());
    set.lines.push_back(line);
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isContinued[i] == 0) readFrom(i);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isUsed[i] == 0) readFrom(i);
  }
}

}  // namespace

const PolylineSet& SilhouetteChainer::chain(
    const SilhouetteField& field,
    const SilhouetteView& view,
    const SilhouetteResult& found) {
  lines_.points.clear();
  lines_.lines.clear();
  lines_.halfEdges.clear();
  lines_.faces.clear();
  const HalfEdgeMesh& mesh = field.mesh();
  if (found.kind == SilhouetteKind::kEdges) {
    const std::span<const HalfEdgeId> edges = found.edges;
    linkEdges(field, edges);
    const auto pointOf = [&](std::uint32_t v) { return glm::vec3(field.positions()[v]); };
    readLines(
        next_,
        isContinued_,
        isUsed_,
        lines_,
        [&](std::uint32_t i, std::uint32_t) {
          const HalfEdgeId h = edges[i];
          append(lines_, pointOf(mesh.origin(h)), h, HalfEdgeMesh::face(h));
        },
        [&](std::uint32_t last) {
          append(lines_, pointOf(mesh.target(edges[last])), kNone, kNone);
        });
    return lines_;
  }
  const std::span<const FaceId> faces = found.faces;
  const glm::vec4 eye = field.eyeOf(view);
  linkFaces(field, eye, faces);
  SmoothWalk walk(field, eye);
  readLines(
      next_,
      isContinued_,
      isUsed_,
      lines_,
      [&](std::uint32_t i, std::uint32_t previous) {
        // A segment starts where the one before ends, to the last bit.
        glm::vec3 start(0.0F);
        if (previous != kNone) {
          start = ends_[previous];
        } else if (walk.start(faces[i])) {
          start = walk.entryPoint();
        }
        append(lines_, start, kNone, faces[i]);
      },
      [&](std::uint32_t last) { append(lines_, ends_[last], kNone, kNone); });
  return lines_;
}

// Enters the names of the segments; bound: above every name.
void SilhouetteChainer::name(std::span<const std::uint32_t> names, std::size_t bound) {
  places_.resize(bound, 0);
  for (std::uint32_t i = 0; i < names.size(); ++i)
    places_[names[i]] = i;
  next_.assign(names.size(), kNone);
  isContinued_.assign(names.size(), 0);
}

// The segment of that name, or kNone.
std::uint32_t SilhouetteChainer::placeOf(
    std::uint32_t segmentName,
    std::span<const std::uint32_t> names) const {
  const std::uint32_t place = places_[segmentName];
  return place < names.size() && names[place] == segmentName ? place : kNone;
}

void SilhouetteChainer::linkEdges(const SilhouetteField& field, std::span<const HalfEdgeId> edges) {
  const HalfEdgeMesh& mesh = field.mesh();
  name(edges, mesh.origins.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    // Clockwise round the target through the front sector. Where not every silhouette was found,
    // the turn may come round to the edge's own back face.
    const HalfEdgeId last = mesh.twins[edges[i]];
    for (HalfEdgeId g = HalfEdgeMesh::next(edges[i]); g != kNone && g != last;
         g = mesh.rotateCw(g)) {
      const std::uint32_t place = placeOf(g, edges);
      if (place == kNone) continue;
      next_[i] = place;
      isContinued_[place] = 1;
      break;
    }
  }
}

void SilhouetteChainer::linkFaces(
    const SilhouetteField& field,
    const glm::vec4& eye,
    std::span<const FaceId> faces) {
  const HalfEdgeMesh& mesh = field.mesh();
  name(faces, mesh.faceCount());
  ends_.resize(faces.size());
  SmoothWalk walk(field, eye);
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    if (!walk.start(faces[i])) continue;
    ends_[i] = walk.exitPoint();
    const HalfEdgeId across = mesh.twins[walk.exit()];
    if (across == kNone) continue;
    next_[i] = placeOf(HalfEdgeMesh::face(across), faces);
    if (next_[i] != kNone) isContinued_[next_[i]] = 1;
  }
}

}  // namespace limn
