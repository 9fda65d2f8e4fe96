// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/scene_faces.h"
#include "client/stroke/visibility/line_crossings.h"
#include "client/stroke/visibility/line_span_set.h"
#include "client/stroke/visibility/outline_walk.h"
#include "client/stroke/visibility/span_segments.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Finds the spans of a view's lines that run behind an outline without passing it: a step
/// outwards comes out from behind it. Internal to LineSpanFinder. Threads: one caller at a time.
class SpanProber {
 public:
  /// How many probes of a span there were, and how many say that it is hidden.
  struct Probes {
    double lengthPx = 0.0;
    int asked = 0;
    int hidden = 0;
  };

  /// What is kept from frame to frame.
  struct Memory {
    std::vector<Probes> probes;  // by span of the line at hand
    std::vector<LineCrossings::Crossing> found;
  };

  /// Refers to its arguments. Which lines there are says what is asked for: where silhouettes are
  /// smooth, segments on edges alone.
  enum class Lines : std::uint8_t { kPolygonal, kSmooth };

  SpanProber(
      const PolylineSet& lines,
      const LineScene& scene,
      const LineCrossings& crossings,
      Lines kind,
      Memory& memory);

  /// Of a line's spans, those from firstSpan on, the ones about which nothing is known are hidden
  /// (smooth: doubtful) where more than half of their probes say so. Cost: O(length in pixels).
  void probe(std::span<const SpanSegment> segments, std::size_t firstSpan, LineSpans& spans);

 private:
  template <class Visit>
  void forOpenPieces(
      std::span<const SpanSegment> segments,
      std::size_t firstSpan,
      const LineSpans& spans,
      Visit visit);

  [[nodiscard]] bool isCoveredAround(const SpanSegment& segment, double t) const;
  [[nodiscard]] bool comesOut(const SpanSegment& segment, double t, const glm::dvec3& step);
  [[nodiscard]] glm::dvec3 placeAt(const SpanSegment& segment, double t) const;
  [[nodiscard]] bool isBehind(const glm::dvec3& place, FaceId face) const;

  const PolylineSet& lines_;
  const LineScene& scene_;
  const LineCrossings& crossings_;
  Lines kind_;
  Memory& memory_;
  SceneFaces faces_;
  OutlineWalk walk_;
};

}  // namespace limn
