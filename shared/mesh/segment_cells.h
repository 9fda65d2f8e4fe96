// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

struct Segment {
  glm::dvec3 from{0.0};
  glm::dvec3 along{0.0};  // to its end
};

/// Segments by the cells of a cubic grid that they come near: which of them may lie near a place is
/// then one look-up. Cells are about as long as the segments are on average and share a table of
/// fixed size, so that a few segments far away may be named beside those that are near.
/// Threads: reentrant.
class SegmentCells {
 public:
  /// reach: how near is near, same units as the segments; above 0.
  /// Cost: O(segments), however unlike their lengths are.
  SegmentCells(std::span<const Segment> segments, double reach);

  /// At least the segments no farther from p than the reach: ascending numbers, some twice.
  [[nodiscard]] std::span<const std::uint32_t> near(const glm::dvec3& p) const {
    return slot(slotOf(glm::i64vec3(glm::floor(p / cell_))));
  }

  /// visit(number) for at least the segments that come no farther from this one than the reach; for
  /// some more than once.
  template <class Visit>
  void visitNear(const Segment& segment, Visit visit) const {
    visitSlots(segment, 0.0, [&](std::size_t at) {
      for (const std::uint32_t other : slot(at))
        visit(other);
    });
  }

 private:
  [[nodiscard]] std::size_t slotOf(const glm::i64vec3& cell) const {
    const std::uint64_t mixed = static_cast<std::uint64_t>(cell.x) * 0x9E3779B97F4A7C15ULL ^
                                static_cast<std::uint64_t>(cell.y) * 0xC2B2AE3D27D4EB4FULL ^
                                static_cast<std::uint64_t>(cell.z) * 0x165667B19E3779F9ULL;
    return (mixed ^ mixed >> 32U) & mask_;
  }

  [[nodiscard]] std::span<const std::uint32_t> slot(std::size_t at) const {
    return std::span(entries_).subspan(begins_[at], begins_[at + 1] - begins_[at]);
  }

  /// visit(slot) for all cells no farther than `reach` from a segment, and some more.
  template <class Visit>
  void visitSlots(const Segment& segment, double reach, Visit visit) const {
    const int pieces = std::max(1, static_cast<int>(std::ceil(glm::length(segment.along) / cell_)));
    for (int k = 0; k < pieces; ++k) {
      const glm::dvec3 a = segment.from + segment.along * (double(k) / pieces);
      const glm::dvec3 b = segment.from + segment.along * (double(k + 1) / pieces);
      const glm::i64vec3 low(glm::floor((glm::min(a, b) - reach) / cell_));
      const glm::i64vec3 high(glm::floor((glm::max(a, b) + reach) / cell_));
      for (std::int64_t x = low.x; x <= high.x; ++x)
        for (std::int64_t y = low.y; y <= high.y; ++y)
          for (std::int64_t z = low.z; z <= high.z; ++z)
            visit(slotOf({x, y, z}));
    }
  }

  double cell_ = 1.0;  // edge
  std::size_t mask_ = 0;
  std::vector<std::uint32_t> begins_;   // of a slot's entries; one more than slots
  std::vector<std::uint32_t> entries_;  // numbers of segments
};

}  // namespace limn
