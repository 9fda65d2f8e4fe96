// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/chain/surface_lines.h"

#include "shared/progressive/vertex_split.h"
#include "shared/ray/self_intersections.h"
#include "shared/silhouette/ridges.h"

#include <algorithm>
#include <vector>

namespace limn {
namespace {

/// Where ridges run depends on the curvature's derivative, which a scan's noise turns about more
/// than the curvature itself: twice the smoothing of suggestive contours.
constexpr double kRidgeSmoothing = 0.016;
constexpr double kRidgeSmoothingEdges = 3.0;

/// Segments by the ends of theirs that meet: end 2s is the start of segments[s], 2s + 1 its end.
class SegmentChainer {
 public:
  SegmentChainer(std::span<const SurfaceSegment> segments, LineKind kind, PolylineSet& out)
      : segments_(segments),
        kind_(kind),
        out_(out) {}

  void run() {
    pairEnds();
    isUsed_.assign(segments_.size(), 0);
    const auto ends = static_cast<std::uint32_t>(2 * segments_.size());
    // From starts first, so that lines run as their segments do.
    for (const std::uint32_t side : {0U, 1U}) {
      for (std::uint32_t end = side; end < ends; end += 2)
        if (partners_[end] == kNone) walkFrom(end);
    }
    for (std::uint32_t end = 0; end < ends; end += 2)
      walkFrom(end);
    out_.strengths.resize(out_.points.size(), 1.0F);
  }

 private:
  [[nodiscard]] const SurfaceSegment::End& at(std::uint32_t end) const {
    return segments_[end / 2].ends[end % 2];
  }

  void pairEnds() {
    std::vector<std::uint32_t> order(2 * segments_.size());
    for (std::uint32_t end = 0; end < order.size(); ++end)
      order[end] = end;
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return at(a).node != at(b).node ? at(a).node < at(b).node : a < b;
    });
    partners_.assign(order.size(), kNone);
    for (std::size_t first = 0; first < order.size();) {
      std::size_t past = first + 1;
      while (past < order.size() && at(order[past]).node == at(order[first]).node)
        ++past;
      if (past == first + 2) {
        partners_[order[first]] = order[first + 1];
        partners_[order[first + 1]] = order[first];
      }
      first = past;
    }
  }

  void add(const SurfaceSegment::End& end, FaceId face) {
    out_.points.push_back(end.point);
    out_.halfEdges.push_back(kNone);
    out_.faces.push_back(face);
    out_.strengths.push_back(end.strength);
  }

  void walkFrom(std::uint32_t start) {
    if (isUsed_[start / 2] != 0) return;
    out_.strengths.resize(out_.points.size(), 1.0F);
    PolylineSet::Line line;
    line.kind = kind_;
    line.onSurface = true;
    line.begin = static_cast<std::uint32_t>(out_.points.size());
    std::uint32_t end = start;
    for (;;) {
      isUsed_[end / 2] = 1;
      add(at(end), segments_[end / 2].face);
      const std::uint32_t following = partners_[end ^ 1U];
      line.closed = following == start;
      if (line.closed) break;
      if (following == kNone) {
        add(at(end ^ 1U), kNone);
        break;
      }
      end = following;
    }
    line.end = static_cast<std::uint32_t>(out_.points.size());
    out_.lines.push_back(line);
  }

  std::span<const SurfaceSegment> segments_;
  LineKind kind_;
  PolylineSet& out_;
  std::vector<std::uint32_t> partners_;  // by end: the one it goes on to, or kNone
  std::vector<std::uint8_t> isUsed_;     // by segment
};

}  // namespace

void chainSegments(std::span<const SurfaceSegment> segments, LineKind kind, PolylineSet& out) {
  SegmentChainer(segments, kind, out).run();
}

SurfaceLines::SurfaceLines(
    const HalfEdgeMesh& mesh,
    std::span<const glm::ivec3> positions,
    std::span<const std::uint8_t> features,
    const SurfaceLineChoice& choice) {
  std::vector<std::uint8_t> sharp(features.begin(), features.end());
  for (std::uint8_t& feature : sharp)
    feature &= kFeatureCrease;
  CurvatureOptions options;
  options.sharp = sharp;
  if (choice.suggestive) {
    curvature_ = curvatureOf(mesh, positions, options);
    suggestive_.emplace(mesh, positions, curvature_);
  }
  if (choice.ridge || choice.valley) {
    options.smoothing = kRidgeSmoothing;
    options.smoothingEdges = kRidgeSmoothingEdges;
    const SurfaceCurvature curvature = curvatureOf(mesh, positions, options);
    const auto add = [&](RidgeKind kind, LineKind line) {
      chainSegments(findRidges(mesh, positions, curvature, kind), line, fixed_);
    };
    if (choice.ridge) add(RidgeKind::kRidge, LineKind::kRidge);
    if (choice.valley) add(RidgeKind::kValley, LineKind::kValley);
  }
  if (choice.intersection)
    chainSegments(findSelfIntersections(mesh, positions), LineKind::kIntersection, fixed_);
}

void SurfaceLines::append(const SilhouetteView& view, PolylineSet& lines) {
  for (const PolylineSet::Line& line : fixed_.lines)
    appendLine(fixed_, line, lines);
  if (suggestive_) chainSegments(suggestive_->find(view), LineKind::kSuggestive, lines);
}

}  // namespace limn
