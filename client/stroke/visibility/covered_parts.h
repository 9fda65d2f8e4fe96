// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/visibility/cover_search.h"
#include "client/stroke/visibility/line_span_set.h"
#include "client/stroke/visibility/span_segments.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// How near an outline has to be to a line in the picture for its surface to be tried: as far as
/// the depth image may take the one for the other.
inline constexpr float kCoverReachPx = 1.0F;

/// Finds the parts of a view's lines that the surface around another line covers. Keeps its working
/// memory; internal to LineSpanFinder. Threads: one caller at a time.
class CoveredParts {
 public:
  /// A part of a piece (LineSpans::Piece), in the same shares.
  struct Part {
    std::uint32_t piece = 0;
    float from = 0.0F;
    float to = 0.0F;
  };

  /// What is looked at, for the length of a line.
  struct View {
    const PolylineSet& lines;
    const SpanSegments& segments;         // of every line
    std::span<const std::uint32_t> near;  // edges, SpanSegment::nearBegin … nearEnd
  };

  /// Another line.
  void begin() { parts_.clear(); }

  /// The line's next piece, along the line; asks for it when there is enough to ask for.
  void add(const View& view, CoverSearch& search, const SpanSegment& segment, const Part& piece);

  /// The pieces so far are asked for; what comes next is not beside them.
  void flush(const View& view, CoverSearch& search);

  /// Cuts the line's pieces, those from firstPiece on, and from its first point's on, where covered
  /// parts of them begin and end; these are hidden.
  void hide(std::uint32_t firstPoint, std::size_t firstPiece, LineSpans& spans);

 private:
  struct Waiting {
    const SpanSegment* segment;
    Part piece;
  };

  [[nodiscard]] bool
  isCovered(const View& view, CoverSearch& search, const SpanSegment& segment, double t);

  std::vector<Part> parts_;  // in the order of the pieces
  std::vector<Waiting> waiting_;
  double waitingPx_ = 0.0;
  std::vector<FaceId> faces_;
  std::vector<LineSpans::Piece> pieces_;  // as they were
};

}  // namespace limn
