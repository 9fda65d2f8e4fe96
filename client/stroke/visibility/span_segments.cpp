// SPDX-License-Identifier: Apache-2.0
// Based on: J. J. Koenderink, "What does the occluding contour tell us about solid shape?",
// Perception 13, 1984: a contour is hidden by its own surface where that curves towards the viewer;
// of a mesh at concave edges, of a smooth silhouette where the front side lies farther away than
// the back side.
#include "client/stroke/visibility/span_segments.h"

#include "client/stroke/clip_segment.h"
#include "client/stroke/scene_faces.h"
#include "client/stroke/visibility/cover_search.h"
#include "client/stroke/visibility/prefetch_faces.h"

#include "shared/mesh/edge_shape.h"

#include <algorithm>

namespace limn {
namespace {

// Shares of a segment in space become those of its part in the picture. aw, bw: w of its ends.
void coveredInPicture(double aw, double bw, const ClipSpan& part, SpanSegment& segment) {
  const double from = aw + part.begin * (bw - aw);
  const double to = aw + part.end * (bw - aw);
  const auto inPicture = [&](double share) {
    const double in = std::clamp((share - part.begin) / (part.end - part.begin), 0.0, 1.0);
    return static_cast<float>(in * to / ((1.0 - in) * from + in * to));
  };
  segment.coveredFromStart = inPicture(segment.coveredFromStart);
  segment.coveredFromEnd = 1.0F - inPicture(1.0 - segment.coveredFromEnd);
}

// Segments at which a surface ends become edges that hide others.
void addEdges(const Viewport& viewport, SpanSegments& segments) {
  segments.crossings.begin(viewport);
  segments.edgeSegment.clear();
  segments.edgeRun.clear();
  for (std::uint32_t i = 0; i < segments.all.size(); ++i) {
    SpanSegment& segment = segments.all[i];
    if (!segment.isInPicture || segment.openSide == 0) continue;
    segment.edge = static_cast<std::uint32_t>(segments.edgeSegment.size());
    // An open line's last point is not the next one's first; a loop goes back to its own.
    const bool goesOn = segment.edge > 0 && segments.edgeSegment.back() + 1 == i &&
                        segments.all[i - 1].next == segment.begin;
    segments.edgeRun.push_back(goesOn ? segments.edgeRun.back() : segment.edge);
    segments.edgeSegment.push_back(i);
    segments.crossings.addEdgeInPicture(
        segment.from,
        segment.to,
        segment.openSide > 0 ? LineCrossings::Surface::kLeft : LineCrossings::Surface::kRight,
        segment.face);
  }
  segments.crossings.build();
}

/// Looks at one segment after another, as lines have them.
class SegmentGatherer {
 public:
  SegmentGatherer(const PolylineSet& lines, const LineScene& scene)
      : lines_(lines),
        scene_(scene),
        isPolygonal_(!hasSmoothContours(lines)),
        faces_(scene),
        judge_(lines, scene),
        search_(scene),
        clipFromGrid_(clipFromGrid(scene)) {}

  [[nodiscard]] bool isPolygonal() const { return isPolygonal_; }

  // What the mesh around a segment says.
  void judge(const PolylineSet::Line& line, SpanSegment& segment) const {
    const glm::dvec3 from(lines_.points[segment.begin]);
    const glm::dvec3 to(lines_.points[segment.next]);
    const HalfEdgeId h = lines_.halfEdges[segment.point];
    segment.isSmooth = h == kNone;
    segment.face = h != kNone ? HalfEdgeMesh::face(h) : lines_.faces[segment.point];
    const HalfEdgeId twin = h != kNone ? scene_.mesh.twin(h) : kNone;
    if (twin != kNone) segment.other = HalfEdgeMesh::face(twin);
    if (segment.face >= scene_.mesh.faceCount()) return;
    if (h != kNone) {
      judgeEdge(h, line, from, to, segment);
    } else if (line.isContour()) {
      segment.isHidden =
          line.back != PolylineSet::Back::kSeen && faces_.hidesSmooth(segment.face, from, to);
      if (!segment.isHidden) segment.openSide = 1;
    } else {
      segment.isHidden =
          line.back == PolylineSet::Back::kNeverSeen && !faces_.isFront(segment.face);
    }
    if (segment.isHidden) segment.isHiddenAtStart = segment.isHiddenAtEnd = true;
  }

  // Where a segment of a line lies in the picture. Of what its own surface hides nobody asks.
  void place(const PolylineSet::Line& line, SpanSegment& segment, std::span<SegmentFacts> facts) {
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
      facts[segment.point] = judge_.judge(line, segment.point, begin_, end);
    }
    begin_ = end;
  }

 private:
  void judgeEdge(
      HalfEdgeId h,
      const PolylineSet::Line& line,
      const glm::dvec3& from,
      const glm::dvec3& to,
      SpanSegment& segment) const {
    const HalfEdgeId twin = scene_.mesh.twin(h);
    const bool isFrontHere = faces_.isFront(HalfEdgeMesh::face(h));
    const glm::dvec3 origin = faces_.corner(h);
    const glm::dvec3 target = faces_.corner(HalfEdgeMesh::next(h));
    // A half-edge has its face to its left, seen from the front.
    const std::int8_t side = isFrontHere == (glm::dot(to - from, target - origin) > 0.0) ? 1 : -1;
    if (twin == kNone) {
      segment.openSide = side;
    } else {
      const bool isFrontThere = faces_.isFront(HalfEdgeMesh::face(twin));
      const bool isHidden = isFrontHere != isFrontThere || line.isContour()
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
      return isCoveredAtStart(scene_.mesh, scene_.positions, out, h, along, faces_.towardEye(end));
    };
    segment.isHiddenAtStart = isCovered(from, to - from);
    segment.isHiddenAtEnd = isCovered(to, from - to);
  }

  [[nodiscard]] LineEnd endAt(std::uint32_t point) const {
    LineEnd end;
    end.point = point;
    end.inClip = clipFromGrid_ * glm::dvec4(lines_.points[point], 1.0);
    end.isInside = isInPicture(end.inClip);
    end.inPicture = pixelFromClip(end.inClip, scene_.viewport);
    return end;
  }

  const PolylineSet& lines_;
  const LineScene& scene_;
  bool isPolygonal_;
  SceneFaces faces_;
  SegmentJudge judge_;
  CoverSearch search_;
  glm::dmat4 clipFromGrid_;
  LineEnd begin_;  // of the segment at hand: where the one before ended
};

}  // namespace

void SpanSegments::gather(
    const PolylineSet& lines,
    std::span<const std::uint8_t> isWanted,
    const LineScene& scene,
    std::span<SegmentFacts> facts) {
  SegmentGatherer gatherer(lines, scene);
  isPolygonal = gatherer.isPolygonal();
  all.clear();
  lineBegin.clear();
  const auto faceAt = [&](std::size_t point) {
    return isWanted.empty() || isWanted[point] != 0 ? lines.faces[point] : kNone;
  };
  for (const PolylineSet::Line& line : lines.lines) {
    lineBegin.push_back(static_cast<std::uint32_t>(all.size()));
    std::uint32_t begin = line.begin;
    for (std::uint32_t point = line.begin; point < line.begin + line.segmentCount(); ++point) {
      prefetchFaces(scene, point, lines.faces.size(), faceAt);
      // What has no answers of its own, since it is too short, is a part of what comes next.
      const bool isSmooth = lines.halfEdges[point] == kNone;
      if (isSmooth && !isWanted.empty() && isWanted[point] == 0) continue;
      SpanSegment& segment = all.emplace_back();
      segment.begin = isSmooth ? begin : point;
      segment.point = point;
      segment.next = point + 1 < line.end ? point + 1 : line.begin;
      gatherer.judge(line, segment);
      gatherer.place(line, segment, facts);
      begin = point + 1;
    }
  }
  lineBegin.push_back(static_cast<std::uint32_t>(all.size()));
  addEdges(scene.viewport, *this);
}

}  // namespace limn
