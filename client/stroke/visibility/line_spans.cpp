// SPDX-License-Identifier: Apache-2.0
// Based on: A. Appel, "The Notion of Quantitative Invisibility and the Machine Rendering of
// Solids", ACM 1967, and L. Markosian et al., "Real-Time Nonphotorealistic Rendering", SIGGRAPH
// 1997: visibility changes only where a line passes behind a contour and at singular vertices.
// Deviations: nothing is counted along a line, where one wrong step spoils the rest. A place where
// a line passes behind an edge tells on which side of it the line is hidden, and so up to the next
// place of change. Lines that run behind an outline without passing it are probed across: a step
// outwards, past the outline, comes out from behind it; from there, and from the faces around the
// line's own edge, a walk over the surface tells whether it covers the line.
#include "client/stroke/visibility/line_spans.h"

#include "client/stroke/visibility/cover_search.h"

#include <algorithm>

namespace limn {
namespace {

/// Smooth silhouettes before one by less than this many of its biases belong to its own surface.
constexpr double kOwnSurface = 4.0;

/// The line itself goes on in so many edges before and after a segment's: its own surface.
constexpr std::uint32_t kOwnEdges = 4;

}  // namespace

/// Cuts the lines of one view.
class SpanCutter {
 public:
  using Segment = SpanSegment;
  using State = LineSpans::State;

  /// memory: with the view's segments.
  SpanCutter(
      const PolylineSet& lines,
      const LineScene& scene,
      LineSpanFinder& memory,
      LineSpans& out)
      : lines_(lines),
        memory_(memory),
        segments_(memory.segments_),
        out_(out),
        search_(scene),
        prober_(
            lines,
            scene,
            segments_.crossings,
            segments_.isPolygonal ? SpanProber::Lines::kPolygonal : SpanProber::Lines::kSmooth,
            memory.probes_) {}

  /// Appends the pieces of a line, and `begin` of its points.
  void cut(std::size_t index) {
    const PolylineSet::Line& line = lines_.lines[index];
    const std::span<Segment> segments = segments_.ofLine(index);
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
    if (!segments_.isPolygonal) cover(segments, line.begin, firstPiece);
  }

 private:
  void end(double share) {
    out_.pieces.push_back(
        {static_cast<float>(share), static_cast<std::uint32_t>(out_.states.size() - 1)});
  }

  // Smooth silhouettes and their mesh's outline differ, so that one cannot be sure of either.
  void hide() {
    State& state = out_.states.back();
    state = std::max(state, segments_.isPolygonal ? State::kHidden : State::kDoubtful);
  }

  // Where a segment passes behind others' surfaces (found_).
  void meet(Segment& segment) {
    std::vector<LineCrossings::Crossing>& found = memory_.found_;
    found.clear();
    if (!segment.isInPicture || segment.isHidden) return;
    if (segments_.isPolygonal || segment.openSide == 0) {
      segments_.crossings.crossInPicture(segment.from, segment.to, found);
    } else {
      meetAlong(segment);
    }
    leaveOutOwn(segment);
  }

  // The same of one that is an edge itself, and which others are beside it.
  void meetAlong(Segment& segment) {
    segment.nearBegin = static_cast<std::uint32_t>(memory_.near_.size());
    segments_.crossings.crossAlong(
        segment.edge,
        memory_.found_,
        {kBesidePx, firstOwnEdge(segment.edge), endOfOwnEdges(segment.edge), memory_.near_});
    segment.nearEnd = static_cast<std::uint32_t>(memory_.near_.size());
    if (!memory_.found_.empty() || !isNearest(segment)) return;
    memory_.near_.resize(segment.nearBegin);
    segment.nearEnd = segment.nearBegin;
    if (segment.isSmooth) out_.isNearest[segment.point] = 1;
  }

  // Edges before and after a segment's are its line's as far as that goes on without a gap: where
  // it turns back, a part of it is hidden.
  [[nodiscard]] std::uint32_t firstOwnEdge(std::uint32_t edge) const {
    return std::max(edge < kOwnEdges ? 0 : edge - kOwnEdges, segments_.edgeRun[edge]);
  }

  [[nodiscard]] std::uint32_t endOfOwnEdges(std::uint32_t edge) const {
    std::uint32_t end = edge + 1;
    while (end < segments_.edgeRun.size() && end <= edge + kOwnEdges &&
           segments_.edgeRun[end] == segments_.edgeRun[edge])
      ++end;
    return end;
  }

  [[nodiscard]] bool isNearest(const Segment& segment) const {
    const auto first = memory_.near_.begin();
    return std::none_of(
        first + segment.nearBegin,
        first + segment.nearEnd,
        [&](std::uint32_t edge) {
          return segments_.crossings.isBefore(edge, segment.from, segment.to, kBesidePx);
        });
  }

  void leaveOutOwn(const Segment& segment) {
    std::vector<LineCrossings::Crossing>& found = memory_.found_;
    if (segments_.isPolygonal || found.empty() || !segment.isSmooth) return;
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
    const CoveredParts::View view{lines_, segments_, memory_.near_};
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
  LineSpanFinder& memory_;
  SpanSegments& segments_;
  LineSpans& out_;
  CoverSearch search_;
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
  segments_.gather(lines, isWanted, scene, out.facts);
  SpanCutter cutter(lines, scene, *this, out);
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
