// SPDX-License-Identifier: Apache-2.0
#include "shared/mesh/segment_cells.h"

#include <algorithm>
#include <bit>

namespace limn {

SegmentCells::SegmentCells(std::span<const Segment> segments, double reach) {
  double sum = 0.0;
  for (const Segment& segment : segments)
    sum += glm::length(segment.along);
  const auto count = static_cast<double>(std::max<std::size_t>(1, segments.size()));
  // Not below four times the reach, or a segment would be in many cells around it.
  cell_ = std::max(sum / count, 4.0 * reach);
  const std::size_t slots = std::bit_ceil(2 * std::max<std::size_t>(1, segments.size()));
  mask_ = slots - 1;
  // Counted, then filled from behind: every slot's numbers ascend.
  const double slightlyMore = 1.0001 * reach;  // a place on the very edge of a cell may be rounded
  begins_.assign(slots + 1, 0);
  for (const Segment& segment : segments)
    visitSlots(segment, slightlyMore, [this](std::size_t at) { ++begins_[at]; });
  std::uint32_t end = 0;
  for (std::uint32_t& begin : begins_) {
    end += begin;
    begin = end;
  }
  entries_.resize(end);
  for (auto i = static_cast<std::uint32_t>(segments.size()); i-- > 0;)
    visitSlots(segments[i], slightlyMore, [this, i](std::size_t at) {
      entries_[--begins_[at]] = i;
    });
}

}  // namespace limn
