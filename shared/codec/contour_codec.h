// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

inline constexpr int kMaxContourExtraBits = 4;

/// Chained silhouettes, flat, on a grid: the model's, made finer by 2^extraBits, same origin.
struct ContourLines {
  struct Line {
    std::uint32_t begin = 0;  // points[begin … end), not empty
    std::uint32_t end = 0;
    bool closed = false;  // the first point is not repeated

    friend bool operator==(const Line&, const Line&) = default;
  };

  int extraBits = 0;               // up to kMaxContourExtraBits
  std::vector<glm::ivec3> points;  // line by line, without gaps
  std::vector<Line> lines;

  friend bool operator==(const ContourLines&, const ContourLines&) = default;
};

/// The bytes of Contour.lines; protocol/SPEC.md, "Contours", is their specification. Differences
/// along the lines, coded with adaptive contexts. The same lines give the same bytes.
/// lines: coordinates within ±2^23. Cost: about 0.3 µs a point. Threads: reentrant.
[[nodiscard]] std::vector<std::uint8_t> encodeContour(const ContourLines& lines);

/// Total over any bytes; at most maxPoints points, checked before anything is allocated.
/// Errors: kCorrupt, kLimitExceeded. Threads: reentrant.
[[nodiscard]] Result<ContourLines> decodeContour(
    std::span<const std::uint8_t> bytes,
    std::uint32_t maxPoints);

}  // namespace limn
