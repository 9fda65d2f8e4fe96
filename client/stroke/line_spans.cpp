// SPDX-License-Identifier: Apache-2.0
// Based on: A. Appel, "The Notion of Quantitative Invisibility and the Machine Rendering of
// Solids", ACM 1967, and L. Markosian et al., "Real-Time Nonphotorealistic Rendering", SIGGRAPH
// 1997: visibility changes only where a line passes behind a contour and at singular vertices.
// J. J. Koenderink, "What does the occluding contour tell us about solid shape?", Perception 13,
// 1984: a contour is hidden by its own surface where that curves towards the viewer; of a mesh at
// concave edges, of a smooth silhouette where the front side lies farther away than the back side.
// Deviations: nothing is counted along a line, where one wrong step spoils the rest. A place where
// a line passes behind an edge tells on which side of it the line is hidden, and so up to the next
// place of change. Lines that run behind an outline without passing it are probed across: a step
// outwards, past the outline, comes out from behind it; from there, and from the faces around the
// line's own edge, a walk over the surface tells whether it covers the line.
#include "client/stroke/line_spans.h"

#include "client/stroke/clip_segment.h"
#include "client/stroke/cover_search.h"
#include "client/stroke/prefetch_faces.h"
#include "client/stroke/segment_facts.h"

#include "shared/mesh/edge_shape.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// Smooth silhouettes before one by less than this many of its biases belong to its own surface.
constexpr double kOwnSurface = 4.0;

/// The line itself goes on in so many edges before and after a segment's: its own surface.
constexpr std::uint32_t kOwnEdges = 4;

}  // namespace

glm::dmat4 clipFromGrid(const LineScene& scene) {
  const glm::dmat4 clipFromWorld = scene.camera.clipFromWorld(scene.viewport.aspect());
  glm::dmat4 m = clipFromWorld * scene.grid.step;
  m[3] = clipFromWorld * glm::dvec4(scene.grid.origin, 1.0);
  return m;
}

/// Cuts the lines of one view.
class SpanCutter {
 public:
  using Segment = SpanSegment;
  using State = LineSpans::State;

  SpanCutter(
      const PolylineSet& lines,
      const LineScene& scene,
      LineSpanFinder& memory,
      LineSpans& out)
      : lines_(lines),
        scene_(scene),
        memory_(memory),
        out_(out),
        judge_(lines, scene),
        search_(scene),
        clipFromGrid_(clipFromGrid(scene)),
        eye_(scene.grid.fromModel(scene.camera.eye)),
        toEyeAtInfinity_(-scene.camera.forward()),
        isPolygonal_(!hasSmoothContours(lines)),
        prober_(
            lines,
            scene,
            memory.crossings_,
            isPolygonal_ ? SpanProber::Lines::kPolygonal : SpanProber::Lines::kSmooth,
            memory.probes_) {}

  /// The segments of all lines, and those at which a surface ends as what hides others.
  void gather(std::span<const std::uint8_t> isWanted) {
    memory_.segments_.clear();
    memory_.lineBegin_.clear();
    const auto faceAt = [&](std::size_t point) {
      return isWanted.empty() || isWanted[point] != 0 ? lines_.faces[point] : kNone;
    };
    for (const PolylineSet::Line& line : lines_.lines) {
      memory_.lineBegin_.push_back(static_cast<std::uint32_t>(memory_.segments_.size()));
      std::uint32_t begin = line.begin;
      for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point) {
        prefetchFaces(scene_, point, lines_.faces.size(), faceAt);
        // What has no answers of its own, since it is too short, is a part of what comes next.
        const bool isSmooth = lines_.halfEdges[point] == kNone;
        if (isSmooth && !isWanted.empty() && isWanted[point] == 0) continue;
        Segment& segment = memory_.segments_.emplace_back();
        segment.begin = isSmooth ? begin : point;
        segment.point = point;
        segment.next = point + 1 < line.end ? point + 1 : line.begin;
        judge(line, segment);
        place(line, segment);
        begin = point + 1;
      }
    }
    memory_.lineBegin_.push_back(static_cast<std::uint32_t>(memory_.segments_.size()));
    memory_.crossings_.begin(scene_.viewport);
    memory_.edgeSegment_.clear();
    memory_.edgeRun_.clear();
    for (std::uint32_t i = 0; i < memory_.segments_.size(); ++i) {
      Segment& segment = memory_.segments_[i];
      if (!segment.isInPicture || segment.openSide == 0) continue;
      segment.edge = static_cast<std::uint32_t>(memory_.edgeSegment_.size());
      const bool goesOn = segment.edge > 0 && memory_.edgeSegment_.back() + 1 == i;
      memory_.edgeRun_.push_back(goesOn ? memory_.edgeRun_.back() : segment.edge);
      memory_.edgeSegment_.push_back(i);
      memory_.crossings_.addEdgeInPicture(
          segment.from,
          segment.to,
          segment.openSide > 0 ? LineCrossings::Surface::kLeft : LineCrossings::Surface::kRight,
          segment.face);
    }
    memory_.crossings_.build();
  }

  /// Appends the pieces of a line, and `begin` of its points.
  void cut(std::size_t index) {
    const PolylineSet::Line& line = lines_.lines[index];
    const auto segments = std::span(memory_.segments_)
                              .subspan(
                                  memory_.lineBegin_[index],
                                  memory_.lineBegin_[index + 1] - memory_.lineBegin_[index]);
    firstSpan_ = out_.states.size();
    const std::size_t firstPiece = out_.pieces.size();
    bool goesOn = false;         // whether the next piece belongs to the span of the one before
    State state = State::kOpen;  // of spans about which nothing else is known
    memory_.near_.clear();
    for (Segment& segment : segments) {
      out_.begin.resize(segment.point + 1, static_cast<std::uint32_t>(out_.pieces.size()));
      const State own = segment.isDoubtful ? State::kDoubtful : State::kOpen;
      if (!goesOn || segment.isHiddenAtStart || own != state) out_.states.push_back(own);
      state = own;
      if (segment.isHiddenAtStart) out_.states.back() = State::kHidden;
      meet(segment);
      for (const LineCrossings::Crossing& c : memory_.found_) {
        end(c.inPicture);
        if (!c.enters) hide();
        out_.states.push_back(state);
        if (c.enters) hide();
      }
      end(1.0);
      if (segment.isHiddenAtEnd) out_.states.back() = State::kHidden;
      goesOn = !segment.isHiddenAtEnd;
    }
    out_.begin.resize(line.end, static_cast<std::uint32_t>(out_.pieces.size()));
    // A loop's last span goes on as its first.
    if (line.closed && goesOn && !segments.front().isHiddenAtStart &&
        segments.front().isDoubtful == segments.back().isDoubtful)
      joinSeam();
    prober_.probe(segments, firstSpan_, out_);
    if (!isPolygonal_) cover(segments, line.begin, firstPiece);
  }

 private:
  [[nodiscard]] static bool isContour(const PolylineSet::Line& line) {
    return line.kind == LineKind::kSilhouette && !line.onSurface;
  }

  [[nodiscard]] glm::dvec3 corner(HalfEdgeId h) const {
    return glm::dvec3(scene_.positions[scene_.mesh.origin(h)]);
  }

  [[nodiscard]] glm::dvec3 normal(FaceId face) const {
    const glm::dvec3 a = corner(3 * face);
    return glm::cross(corner(3 * face + 1) - a, corner(3 * face + 2) - a);
  }

  [[nodiscard]] glm::dvec3 towardEye(const glm::dvec3& p) const {
    return scene_.camera.orthographic ? toEyeAtInfinity_ : eye_ - p;
  }

  [[nodiscard]] bool isFront(FaceId face) const {
    return glm::dot(normal(face), towardEye(corner(3 * face))) > 0.0;
  }

  void end(double share) {
    out_.pieces.push_back(
        {static_cast<float>(share), static_cast<std::uint32_t>(out_.states.size() - 1)});
  }

  // Smooth silhouettes and their mesh's outline differ, so that one cannot be sure of either.
  void hide() {
    State& state = out_.states.back();
    state = std::max(state, isPolygonal_ ? State::kHidden : State::kDoubtful);
  }

  // What the mesh around a segment says.
  void judge(const PolylineSet::Line& line, Segment& segment) const {
    const glm::dvec3 from(lines_.points[segment.begin]);
    const glm::dvec3 to(lines_.points[segment.next]);
    const HalfEdgeId h = lines_.halfEdges[segment.point];
    segment.isSmooth = h == kNone;
    segment.face = h != kNone ? HalfEdgeMesh::face(h) : lines_.faces[segment.point];
    const HalfEdgeId twin = h != kNone ? scene_.mesh.twin(h) : kNone;
    if (twin != kNone) segment.other = HalfEdgeMesh::face(twin);
    if (segment.face < scene_.mesh.faceCount()) {
      if (h != kNone) {
        judgeEdge(h, line, from, to, segment);
      } else if (isContour(line)) {
        // Lines run with the front side to their left: n × along points there. Where that side is
        // the farther one, the surface bends towards the eye and covers the line.
        segment.isHidden =
            line.back != PolylineSet::Back::kSeen &&
            glm::dot(glm::cross(normal(segment.face), to - from), towardEye(0.5 * (from + to))) <
                0.0;
        if (!segment.isHidden) segment.openSide = 1;
      } else {
        segment.isHidden = !isFront(segment.face);
      }
      if (segment.isHidden) segment.isHiddenAtStart = segment.isHiddenAtEnd = true;
    }
  }

  // Where a segment of a line lies in the picture. Of what its own surface hides nobody asks.
  void place(const PolylineSet::Line& line, Segment& segment) {
    if (segment.isHidden) return;
    if (begin_.point != segment.begin) begin_ = endAt(segment.begin);
    const LineEnd end = endAt(segment.next);
    const glm::dvec4& a = begin_.inClip;
    const glm::dvec4& b = end.inClip;
    const ClipSpan part = begin_.isInside && end.isInside ? ClipSpan{} : clipSegment(a, b);
    segment.isInPicture = !part.empty();
    if (segment.isInPicture) {
      if (segment.coveredFromStart > 0.0F || segment.coveredFromEnd > 0.0F)
        coveredInPicture(a.w, b.w, part, segment);
      segment.from = part.begin > 0.0 ? pixelFromClip(a + part.begin * (b - a), scene_.viewport)
                                      : begin_.inPicture;
      segment.to =
          part.end < 1.0 ? pixelFromClip(a + part.end * (b - a), scene_.viewport) : end.inPicture;
      out_.facts[segment.point] = judge_.judge(line, segment.point, begin_, end);
    }
    begin_ = end;
  }

  [[nodiscard]] LineEnd endAt(std::uint32_t point) const {
    LineEnd end;
    end.point = point;
    end.inClip = clipFromGrid_ * glm::dvec4(lines_.points[point], 1.0);
    end.isInside = isInPicture(end.inClip);
    end.inPicture = pixelFromClip(end.inClip, scene_.viewport);
    return end;
  }

  // Shares of a segment in space become those of its part in the picture.
  static void coveredInPicture(double aw, double bw, const ClipSpan& part, Segment& segment) {
    const auto inPicture = [&](double share, double from, double to) {
      const double in = std::clamp((share - part.begin) / (part.end - part.begin), 0.0, 1.0);
      return static_cast<float>(in * to / ((1.0 - in) * from + in * to));
    };
    const double from = aw + part.begin * (bw - aw);
    const double to = aw + part.end * (bw - aw);
    segment.coveredFromStart = inPicture(segment.coveredFromStart, from, to);
    segment.coveredFromEnd = 1.0F - inPicture(1.0 - segment.coveredFromEnd, from, to);
  }

  void judgeEdge(
      HalfEdgeId h,
      const PolylineSet::Line& line,
      const glm::dvec3& from,
      const glm::dvec3& to,
      Segment& segment) const {
    const HalfEdgeId twin = scene_.mesh.twin(h);
    const bool isFrontHere = isFront(HalfEdgeMesh::face(h));
    const glm::dvec3 origin = corner(h);
    const glm::dvec3 target = corner(HalfEdgeMesh::next(h));
    // A half-edge has its face to its left, seen from the front.
    const std::int8_t side = isFrontHere == (glm::dot(to - from, target - origin) > 0.0) ? 1 : -1;
    if (twin == kNone) {
      segment.openSide = side;
    } else {
      const bool isFrontThere = isFront(HalfEdgeMesh::face(twin));
      const bool isHidden = isFrontHere != isFrontThere || isContour(line)
                                ? isConcave(scene_.mesh, scene_.positions, h)
                                : !isFrontHere;
      segment.isHidden = isHidden && line.back == PolylineSet::Back::kNeverSeen;
      segment.isDoubtful = isHidden && !segment.isHidden;
      if (segment.isHidden) return;
      if (isFrontHere != isFrontThere) segment.openSide = side;
    }
    if (!isPolygonal_) {
      if (segment.openSide == 0 || twin == kNone) return;
      const auto covered = [&](const glm::dvec3& end, const glm::dvec3& other) {
        if (end != origin && end != target) return 0.0F;  // inside the edge
        return static_cast<float>(
            search_.coveredShare(end == origin ? h : twin, other, segment.face, segment.other));
      };
      segment.coveredFromStart = covered(from, to);
      segment.coveredFromEnd = covered(to, from);
      return;
    }
    const auto isCovered = [&](const glm::dvec3& end, const glm::dvec3& along) {
      if (end != origin && end != target) return false;  // inside the edge
      const HalfEdgeId out = end == origin ? h : (twin != kNone ? twin : HalfEdgeMesh::next(h));
      return isCoveredAtStart(scene_.mesh, scene_.positions, out, h, along, towardEye(end));
    };
    segment.isHiddenAtStart = isCovered(from, to - from);
    segment.isHiddenAtEnd = isCovered(to, from - to);
  }

  // Where a segment passes behind others' surfaces (found_).
  void meet(Segment& segment) {
    std::vector<LineCrossings::Crossing>& found = memory_.found_;
    found.clear();
    if (!segment.isInPicture || segment.isHidden) return;
    if (isPolygonal_ || segment.openSide == 0) {
      memory_.crossings_.crossInPicture(segment.from, segment.to, found);
    } else {
      segment.nearBegin = static_cast<std::uint32_t>(memory_.near_.size());
      const LineCrossings::Beside beside{
          kBesidePx,
          firstOwnEdge(segment),
          endOfOwnEdges(segment),
          memory_.near_};
      memory_.crossings_.crossAlong(segment.edge, found, beside);
      segment.nearEnd = static_cast<std::uint32_t>(memory_.near_.size());
      if (found.empty() && isNearest(segment)) {
        memory_.near_.resize(segment.nearBegin);
        segment.nearEnd = segment.nearBegin;
        if (segment.isSmooth) out_.isNearest[segment.point] = 1;
      }
    }
    leaveOutOwn(segment);
  }

  // Edges before and after a segment's are its line's as far as that goes on without a gap: where
  // it turns back, a part of it is hidden.
  [[nodiscard]] std::uint32_t firstOwnEdge(const Segment& segment) const {
    const std::uint32_t first = segment.edge < kOwnEdges ? 0 : segment.edge - kOwnEdges;
    return std::max(first, memory_.edgeRun_[segment.edge]);
  }

  [[nodiscard]] std::uint32_t endOfOwnEdges(const Segment& segment) const {
    std::uint32_t end = segment.edge + 1;
    while (end < memory_.edgeRun_.size() && end <= segment.edge + kOwnEdges &&
           memory_.edgeRun_[end] == memory_.edgeRun_[segment.edge])
      ++end;
    return end;
  }

  [[nodiscard]] bool isNearest(const Segment& segment) const {
    const auto first = memory_.near_.begin();
    return std::none_of(
        first + segment.nearBegin,
        first + segment.nearEnd,
        [&](std::uint32_t edge) {
          return memory_.crossings_.isBefore(edge, segment.from, segment.to, kBesidePx);
        });
  }

  void leaveOutOwn(const Segment& segment) {
    std::vector<LineCrossings::Crossing>& found = memory_.found_;
    if (isPolygonal_ || found.empty() || !segment.isSmooth) return;
    const double own = kOwnSurface * out_.facts[segment.point].bias;
    std::erase_if(found, [&](const LineCrossings::Crossing& c) { return c.gap < own; });
  }

  void joinSeam() {
    const auto last = static_cast<std::uint32_t>(out_.states.size() - 1);
    if (last == firstSpan_) return;
    out_.states[firstSpan_] = std::max(out_.states[firstSpan_], out_.states[last]);
    for (std::size_t i = out_.pieces.size(); i-- > 0 && out_.pieces[i].span == last;)
      out_.pieces[i].span = static_cast<std::uint32_t>(firstSpan_);
  }

  // Parts that surfaces beside them cover are hidden, whatever their span is.
  void cover(std::span<const Segment> segments, std::uint32_t firstPoint, std::size_t firstPiece) {
    CoveredParts& covered = memory_.covered_;
    const CoveredParts::View view{
        lines_,
        memory_.crossings_,
        memory_.segments_,
        memory_.edgeSegment_,
        memory_.near_};
    covered.begin();
    for (const Segment& segment : segments) {
      if (segment.openSide == 0 || !segment.isInPicture) {
        covered.flush(view, search_);
        continue;
      }
      float from = 0.0F;
      for (std::uint32_t i = out_.begin[segment.point]; from < 1.0F; ++i) {
        const LineSpans::Piece& piece = out_.pieces[i];
        if (out_.states[piece.span] == State::kHidden) {
          covered.flush(view, search_);
        } else {
          covered.add(view, search_, segment, {i, from, piece.end});
        }
        from = piece.end;
      }
    }
    covered.flush(view, search_);
    covered.hide(firstPoint, firstPiece, out_);
  }

  const PolylineSet& lines_;
  const LineScene& scene_;
  LineSpanFinder& memory_;
  LineSpans& out_;
  LineEnd begin_;  // of the segment at hand: where the one before ended
  SegmentJudge judge_;
  CoverSearch search_;
  glm::dmat4 clipFromGrid_;
  glm::dvec3 eye_;  // grid units
  glm::dvec3 toEyeAtInfinity_;
  bool isPolygonal_;  // no silhouette is smooth: lines are exact
  SpanProber prober_;
  std::size_t firstSpan_ = 0;  // of the line at hand
};

void LineSpanFinder::find(
    const PolylineSet& lines,
    std::span<const std::uint8_t> isWanted,
    const LineScene& scene,
    LineSpans& out) {
  out.pieces.clear();
  out.begin.clear();
  out.states.clear();
  out.isNearest.assign(lines.points.size(), 0);
  out.facts.assign(lines.points.size(), {});
  SpanCutter cutter(lines, scene, *this, out);
  cutter.gather(isWanted);
  for (std::size_t i = 0; i < lines.lines.size(); ++i)
    cutter.cut(i);
  out.begin.push_back(static_cast<std::uint32_t>(out.pieces.size()));
}

LineSpans findSpans(const PolylineSet& lines, const LineScene& scene) {
  LineSpans out;
  LineSpanFinder().find(lines, {}, scene, out);
  return out;
}

}  // namespace limn
