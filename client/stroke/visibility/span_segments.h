// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/visibility/line_crossings.h"
#include "client/stroke/visibility/segment_facts.h"

#include "shared/core/ids.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// A segment of a line as the picture has it. Internal to LineSpanFinder.
struct SpanSegment {
  glm::dvec3 from{0.0};  // pixels, window depth
  glm::dvec3 to{0.0};
  std::uint32_t begin = 0;  // points: where it starts, whose answers it has, where it ends
  std::uint32_t point = 0;
  std::uint32_t next = 0;
  FaceId face = kNone;
  FaceId other = kNone;   // across its edge, if it is one with two faces
  bool isSmooth = false;  // on no edge
  bool isInPicture = false;
  bool isHidden = false;    // by its own surface, all along it
  bool isDoubtful = false;  // hidden so if the back side of its surface cannot be seen
  bool isHiddenAtStart = false;
  bool isHiddenAtEnd = false;
  /// Where in the picture its surface ends: 1 right of it, −1 left, 0 nowhere.
  std::int8_t openSide = 0;
  std::uint32_t edge = 0;  // its number among LineCrossings' edges, where a surface ends at it
  /// Shares of it in the picture, from its start and from its end, that the faces around these
  /// cover. Only where silhouettes are smooth.
  float coveredFromStart = 0.0F;
  float coveredFromEnd = 0.0F;
  std::uint32_t nearBegin = 0;  // into the numbers of edges beside it
  std::uint32_t nearEnd = 0;
};

/// The segments of a view's lines, and those at which a surface ends as edges that hide others.
/// Kept from frame to frame by LineSpanFinder, and internal to it.
struct SpanSegments {
  std::vector<SpanSegment> all;          // line by line
  std::vector<std::uint32_t> lineBegin;  // by line, and one past the last: into `all`
  bool isPolygonal = true;               // no silhouette is smooth: lines are exact
  LineCrossings crossings;
  std::vector<std::uint32_t> edgeSegment;  // by edge of crossings: into `all`
  std::vector<std::uint32_t> edgeRun;      // by edge: the first of those of a line without a gap

  [[nodiscard]] std::span<SpanSegment> ofLine(std::size_t line) {
    return std::span(all).subspan(lineBegin[line], lineBegin[line + 1] - lineBegin[line]);
  }

  /// Fills all of it anew: how segments lie in the picture, and what the mesh around each says of
  /// it. isWanted: see LineSpanFinder::find. facts, one a point: set for segments in the picture
  /// that are not all hidden. Cost: O(segments · valence).
  void gather(
      const PolylineSet& lines,
      std::span<const std::uint8_t> isWanted,
      const LineScene& scene,
      std::span<SegmentFacts> facts);
};

}  // namespace limn
