// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/visibility/covered_parts.h"
#include "client/stroke/visibility/line_crossings.h"
#include "client/stroke/visibility/line_span_set.h"
#include "client/stroke/visibility/span_prober.h"
#include "client/stroke/visibility/span_segments.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Finds LineSpans. Keeps its working memory from frame to frame. Threads: one caller at a time.
class LineSpanFinder {
 public:
  /// Fills `out` anew. isWanted: one entry a point, or empty (all): the segments that are asked for
  /// later (SpineSet::source); smooth silhouettes are taken as they are in between.
  /// Cost: O(segments · valence + crossings).
  void find(
      const PolylineSet& lines,
      std::span<const std::uint8_t> isWanted,
      const LineScene& scene,
      LineSpans& out);

 private:
  friend class SpanCutter;

  SpanSegments segments_;
  SpanProber::Memory probes_;
  std::vector<LineCrossings::Crossing> found_;
  std::vector<std::uint32_t> near_;  // edges beside segments of the line at hand
  CoveredParts covered_;
};

/// LineSpanFinder once, for every line.
[[nodiscard]] LineSpans findSpans(const PolylineSet& lines, const LineScene& scene);

}  // namespace limn
