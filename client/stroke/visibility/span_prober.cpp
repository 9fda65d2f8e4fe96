// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/visibility/span_prober.h"

#include <algorithm>

namespace limn {
namespace {

/// Probes reach this far; farther from an outline the depth image cannot be mistaken.
constexpr double kProbePx = 1.5;
/// A probe each pixel, and no more than this many a span.
constexpr double kMostProbes = 16.0;
/// Window depth behind all there is in the picture.
constexpr double kBehindAll = 2.0;

}  // namespace

SpanProber::SpanProber(
    const PolylineSet& lines,
    const LineScene& scene,
    const LineCrossings& crossings,
    Lines kind,
    Memory& memory)
    : lines_(lines),
      scene_(scene),
      crossings_(crossings),
      kind_(kind),
      memory_(memory),
      faces_(scene),
      walk_(scene) {}

void SpanProber::probe(
    std::span<const SpanSegment> segments,
    std::size_t firstSpan,
    LineSpans& spans) {
  memory_.probes.assign(spans.states.size() - firstSpan, {});
  forOpenPieces(
      segments,
      firstSpan,
      spans,
      [](Probes& probes, const SpanSegment& s, double a, double b) {
        probes.lengthPx += (b - a) * glm::distance(glm::dvec2(s.from), glm::dvec2(s.to));
      });
  forOpenPieces(
      segments,
      firstSpan,
      spans,
      [&](Probes& probes, const SpanSegment& s, double a, double b) {
        const glm::dvec2 along(s.to - s.from);
        const double length = glm::length(along);
        if (!(length > 1e-9)) return;
        // Rows run down: right of (x, y) is (−y, x).
        const glm::dvec3 step =
            glm::dvec3(-along.y, along.x, 0.0) * (s.openSide * kProbePx / length);
        const double spacing = std::max(1.0, probes.lengthPx / kMostProbes);
        const int count = std::max(1, static_cast<int>((b - a) * length / spacing));
        for (int k = 0; k < count; ++k) {
          ++probes.asked;
          const double t = a + (b - a) * (k + 0.5) / count;
          if (isCoveredAround(s, t) || comesOut(s, t, step)) ++probes.hidden;
        }
      });
  for (std::size_t i = 0; i < memory_.probes.size(); ++i) {
    const Probes& probes = memory_.probes[i];
    if (probes.hidden > 0 && 2 * probes.hidden > probes.asked)
      spans.states[firstSpan + i] =
          kind_ == Lines::kPolygonal ? LineSpans::State::kHidden : LineSpans::State::kDoubtful;
  }
}

// visit(probes of its span, segment, from, to) for pieces at which a surface ends.
template <class Visit>
void SpanProber::forOpenPieces(
    std::span<const SpanSegment> segments,
    std::size_t firstSpan,
    const LineSpans& spans,
    Visit visit) {
  for (const SpanSegment& segment : segments) {
    if (segment.openSide == 0 || !segment.isInPicture) continue;
    if (segment.isSmooth && kind_ == Lines::kSmooth) continue;  // CoveredParts asks for them
    double from = 0.0;
    for (std::size_t i = spans.begin[segment.point]; from < 1.0; ++i) {
      const std::uint32_t span = spans.pieces[i].span;
      if (spans.states[span] == LineSpans::State::kOpen)
        visit(memory_.probes[span - firstSpan], segment, from, spans.pieces[i].end);
      from = spans.pieces[i].end;
    }
  }
}

// Whether a place of an edge is covered by the surface around the edge's ends.
bool SpanProber::isCoveredAround(const SpanSegment& segment, double t) const {
  const glm::dvec3 place = placeAt(segment, t);
  const HalfEdgeId edge = lines_.halfEdges[segment.point];
  const HalfEdgeId twin = scene_.mesh.twin(edge);
  for (const HalfEdgeId start : {edge, twin}) {
    if (start == kNone) continue;
    for (HalfEdgeId h = scene_.mesh.rotateCcw(start); h != kNone && h != start;
         h = scene_.mesh.rotateCcw(h)) {
      const FaceId face = HalfEdgeMesh::face(h);
      if (face != segment.face && face != segment.other &&
          walk_.covers(face, place, segment.face, segment.other) == OutlineWalk::Answer::kCovers)
        return true;
    }
  }
  return false;
}

// Whether a place of a segment is covered by a surface whose outline lies a step outwards.
bool SpanProber::comesOut(const SpanSegment& segment, double t, const glm::dvec3& step) {
  std::vector<LineCrossings::Crossing>& found = memory_.found;
  found.clear();
  // From behind everything: a surface that is steep to the view may cover the place although its
  // outline is farther away than that.
  glm::dvec3 start = glm::mix(segment.from, segment.to, t);
  const double behind = kBehindAll - start.z;
  start.z = kBehindAll;
  crossings_.crossInPicture(start, start + step, found);
  if (found.empty()) return false;
  const glm::dvec3 place = placeAt(segment, t);
  int entered = 0;
  for (const LineCrossings::Crossing& c : found) {
    const bool isBefore = c.gap > behind;
    if (isBefore) entered += c.enters ? 1 : -1;
    if (c.enters) continue;
    const OutlineWalk::Answer answer = walk_.covers(c.face, place, segment.face, segment.other);
    if (answer == OutlineWalk::Answer::kCovers) return true;
    // Where the way over the surface is not known: coming out without having gone in.
    if (answer == OutlineWalk::Answer::kUnknown && isBefore && entered < 0)
      return isBehind(place, c.face);
  }
  return false;
}

// Grid units. The share is that in the picture: close enough where a segment is short to the eye.
glm::dvec3 SpanProber::placeAt(const SpanSegment& segment, double t) const {
  return glm::mix(
      glm::dvec3(lines_.points[segment.begin]),
      glm::dvec3(lines_.points[segment.next]),
      t);
}

// Whether a place lies behind a face's plane: not where the way has passed through.
bool SpanProber::isBehind(const glm::dvec3& place, FaceId face) const {
  const glm::dvec3 fromPlane = place - faces_.corner(3 * face);
  return (glm::dot(faces_.normal(face), fromPlane) < 0.0) == faces_.isFront(face);
}

}  // namespace limn
