// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace limn {

enum class LineKind : std::uint8_t {
  kSilhouette,
  kCrease,
  kBorder,
  kSeam,
  kSuggestive,
  kRidge,
  kValley,
  kIntersection,
};

/// Lines inside the surface, drawn thinner than those that bound it.
[[nodiscard]] inline bool isInner(LineKind kind) {
  return kind != LineKind::kSilhouette && kind != LineKind::kBorder;
}

/// Lines that suggest a shape rather than mark an edge: what is hidden of them is not drawn.
[[nodiscard]] inline bool isSuggestion(LineKind kind) {
  return kind == LineKind::kSuggestive || kind == LineKind::kRidge || kind == LineKind::kValley;
}

/// Chained lines, flat. Points are in grid units of the model (Grid::toModel makes them model
/// units), so that polygonal lines are exact.
struct PolylineSet {
  /// Whether the back side of a surface can be seen (OpenSurfaces): where it cannot, that hides
  /// lines by rule.
  enum class Back : std::uint8_t {
    kNeverSeen,  // closed
    kMayBeSeen,  // open
    kSeen,       // open, and turned so from this view
  };

  struct Line {
    LineKind kind = LineKind::kSilhouette;
    bool closed = false;      // the first point is not repeated
    std::uint32_t begin = 0;  // points[begin … end)
    std::uint32_t end = 0;
    /// It runs over the surface, not where that turns away from the eye: a light's silhouette, or
    /// one of the kinds from kSuggestive on.
    bool onSurface = false;
    Back back = Back::kNeverSeen;  // of its surface

    /// Segments: end − begin for a closed line, one fewer for an open one.
    [[nodiscard]] std::uint32_t segmentCount() const { return end - begin - (closed ? 0 : 1); }

    /// Its surface turns away from the eye there.
    [[nodiscard]] bool isContour() const { return kind == LineKind::kSilhouette && !onSurface; }
  };

  std::vector<glm::vec3> points;
  std::vector<Line> lines;
  /// Parallel to points: the half-edge of the segment that starts at this point (polygonal lines:
  /// the edge itself; smooth silhouettes: kNone). An open line's last entry is kNone.
  std::vector<HalfEdgeId> halfEdges;
  /// Parallel to points: the front-facing (visible-side) face of the segment that starts there.
  std::vector<FaceId> faces;
  /// Parallel to points, or empty (all 1): how much of a line it is there, 0 … 1. Strokes thin out
  /// with it.
  std::vector<float> strengths;
};

/// Whether any silhouette is smooth: without, all contours are edges of the mesh, and exact.
/// Cost: O(points).
[[nodiscard]] inline bool hasSmoothContours(const PolylineSet& lines) {
  return std::any_of(lines.lines.begin(), lines.lines.end(), [&](const PolylineSet::Line& line) {
    const auto first = lines.halfEdges.begin() + line.begin;
    const auto last = first + line.segmentCount();
    return line.isContour() && std::find(first, last, kNone) != last;
  });
}

/// Appends a point of `from` with all that is known about it.
inline void appendPoint(const PolylineSet& from, std::uint32_t point, PolylineSet& to) {
  to.points.push_back(from.points[point]);
  to.halfEdges.push_back(from.halfEdges[point]);
  to.faces.push_back(from.faces[point]);
  if (from.strengths.empty() && to.strengths.empty()) return;
  to.strengths.resize(to.points.size() - 1, 1.0F);
  to.strengths.push_back(from.strengths.empty() ? 1.0F : from.strengths[point]);
}

/// Appends a line of `from`.
inline void appendLine(const PolylineSet& from, const PolylineSet::Line& line, PolylineSet& to) {
  PolylineSet::Line copy = line;
  copy.begin = static_cast<std::uint32_t>(to.points.size());
  for (std::uint32_t i = line.begin; i < line.end; ++i)
    appendPoint(from, i, to);
  copy.end = static_cast<std::uint32_t>(to.points.size());
  to.lines.push_back(copy);
}

}  // namespace limn
