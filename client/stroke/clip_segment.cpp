// SPDX-License-Identifier: Apache-2.0
// Based on: Y.-D. Liang, B. A. Barsky, "A New Concept and Method for Line Clipping", ACM TOG 3(1),
// 1984, for cutting a segment by planes in homogeneous coordinates.
#include "client/stroke/clip_segment.h"

#include <algorithm>
#include <array>

namespace limn {

ClipSpan clipSegment(const glm::dvec4& a, const glm::dvec4& b) {
  const double wide = 1.0 + 2.0 * kSpineMargin;
  // Signed distances to: near plane; left, right, bottom, top.
  const auto distances = [wide](const glm::dvec4& p) {
    return std::array<double, 5>{
        p.z + p.w,
        wide * p.w + p.x,
        wide * p.w - p.x,
        wide * p.w + p.y,
        wide * p.w - p.y};
  };
  const auto from = distances(a);
  const auto to = distances(b);
  ClipSpan span;
  for (std::size_t plane = 0; plane < from.size(); ++plane) {
    if (from[plane] < 0.0 && to[plane] < 0.0) return {1.0, 0.0};
    if (from[plane] >= 0.0 && to[plane] >= 0.0) continue;
    const double t = from[plane] / (from[plane] - to[plane]);
    if (from[plane] < 0.0) {
      span.begin = std::max(span.begin, t);
    } else {
      span.end = std::min(span.end, t);
    }
  }
  return span;
}

}  // namespace limn
