// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/visibility/covered_parts.h"

#include <algorithm>

namespace limn {
namespace {

/// Pieces are asked for this far apart: shorter ones together, in the middle of them.
constexpr double kSpacingPx = 2.0;

}  // namespace

void CoveredParts::add(
    const View& view,
    CoverSearch& search,
    const SpanSegment& segment,
    const Part& piece) {
  const double length =
      (piece.to - piece.from) * glm::distance(glm::dvec2(segment.from), glm::dvec2(segment.to));
  if (waitingPx_ + length > kSpacingPx) flush(view, search);
  waiting_.push_back({&segment, piece});
  waitingPx_ += length;
}

void CoveredParts::flush(const View& view, CoverSearch& search) {
  if (waiting_.empty()) return;
  // An odd number of places, so that one is in the middle.
  const int count = static_cast<int>(waitingPx_ / kSpacingPx) | 1;
  if (waiting_.size() == 1) {
    const auto& [segment, piece] = waiting_.front();
    const auto at = [&piece = piece, count](int k) {
      return k == count ? piece.to
                        : piece.from + (piece.to - piece.from) * static_cast<float>(k) /
                                           static_cast<float>(count);
    };
    for (int k = 0; k < count; ++k) {
      if (isCovered(view, search, *segment, 0.5 * (at(k) + at(k + 1))))
        parts_.push_back({piece.piece, at(k), at(k + 1)});
    }
  } else {
    const auto isCoveredInMiddle = [&](const Waiting& one) {
      return isCovered(view, search, *one.segment, 0.5 * (one.piece.from + one.piece.to));
    };
    if (isCoveredInMiddle(waiting_[waiting_.size() / 2])) {
      for (const Waiting& one : waiting_) {
        if (isCoveredInMiddle(one)) parts_.push_back(one.piece);
      }
    }
  }
  waiting_.clear();
  waitingPx_ = 0.0;
}

void CoveredParts::hide(std::uint32_t firstPoint, std::size_t firstPiece, LineSpans& spans) {
  if (parts_.empty()) return;
  const auto hidden = static_cast<std::uint32_t>(spans.states.size());
  spans.states.push_back(LineSpans::State::kHidden);
  std::vector<LineSpans::Piece>& old = pieces_;
  old.assign(spans.pieces.begin() + static_cast<std::ptrdiff_t>(firstPiece), spans.pieces.end());
  spans.pieces.resize(firstPiece);
  std::size_t part = 0;
  std::size_t next = 0;  // of the old ones
  for (std::size_t point = firstPoint; point < spans.begin.size(); ++point) {
    const std::size_t end =
        point + 1 < spans.begin.size() ? spans.begin[point + 1] - firstPiece : old.size();
    spans.begin[point] = static_cast<std::uint32_t>(spans.pieces.size());
    for (float at = 0.0F; next < end; ++next) {
      for (; part < parts_.size() && parts_[part].piece == firstPiece + next; ++part) {
        if (parts_[part].from > at) spans.pieces.push_back({parts_[part].from, old[next].span});
        spans.pieces.push_back({parts_[part].to, hidden});
        at = parts_[part].to;
      }
      if (old[next].end > at || at == 0.0F) spans.pieces.push_back(old[next]);
      at = old[next].end;
    }
  }
}

bool CoveredParts::isCovered(
    const View& view,
    CoverSearch& search,
    const SpanSegment& segment,
    double t) {
  if (t < segment.coveredFromStart || t > 1.0 - segment.coveredFromEnd) return true;
  if (segment.nearBegin == segment.nearEnd) return false;
  const glm::dvec3 inPicture = glm::mix(segment.from, segment.to, t);
  faces_.clear();
  const auto add = [&](FaceId face) {
    if (face != kNone && std::find(faces_.begin(), faces_.end(), face) == faces_.end())
      faces_.push_back(face);
  };
  for (std::uint32_t i = segment.nearBegin; i < segment.nearEnd; ++i) {
    const std::uint32_t edge = view.near[i];
    if (!view.segments.crossings.isBefore(edge, inPicture, kCoverReachPx)) continue;
    const SpanSegment& beside = view.segments.all[view.segments.edgeSegment[edge]];
    add(beside.face);
    add(beside.other);
  }
  if (faces_.empty()) return false;
  // The share is that in the picture: close enough where a segment is short to the eye.
  const glm::dvec3 from(view.lines.points[segment.begin]);
  const glm::dvec3 to(view.lines.points[segment.next]);
  const glm::dvec3 place = glm::mix(from, to, t);
  if (segment.isSmooth)
    return search.covers(faces_, search.outside(segment.face, to - from, place));
  return search.covers(faces_, {place, segment.face, segment.other});
}

}  // namespace limn
