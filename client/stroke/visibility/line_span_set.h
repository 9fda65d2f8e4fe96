// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/visibility/segment_facts.h"

#include <cstdint>
#include <vector>

namespace limn {

/// Lines within this of one another are one to the eye.
inline constexpr float kBesidePx = 2.5F;

/// Lines cut where their visibility can change: where they pass behind a silhouette or a border
/// among them, and where the faces around one of their points cover them. A span, from one such
/// place to the next, is all visible or all hidden.
struct LineSpans {
  enum class State : std::uint8_t {
    kOpen,      // nothing here says; whatever is in front decides
    kDoubtful,  // hidden, as smooth silhouettes have it, which are not quite their mesh's outline
    kHidden,
  };

  /// A part of a segment, from where the one before ends to `end` (shares of the segment's part in
  /// the picture, affine there).
  struct Piece {
    float end = 1.0F;
    std::uint32_t span = 0;
  };

  std::vector<Piece> pieces;
  std::vector<std::uint32_t> begin;  // by point, and one past the last: into pieces
  std::vector<State> states;         // by span
  /// By point: no line that is nearer to the eye comes within kBesidePx of a smooth silhouette's
  /// segment. What hides it by less than that has no line of its own there.
  std::vector<std::uint8_t> isNearest;
  std::vector<SegmentFacts> facts;  // by point: of its segment, where that is not all hidden

  /// The span at a place of the segment that starts at a point.
  [[nodiscard]] std::uint32_t spanAt(std::uint32_t point, float share) const {
    std::uint32_t i = begin[point];
    while (i + 1 < begin[point + 1] && pieces[i].end < share)
      ++i;
    return pieces[i].span;
  }
};

}  // namespace limn
