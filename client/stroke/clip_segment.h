// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cmath>

namespace limn {

/// How far outside the picture lines are kept, as a fraction of its size on each side.
inline constexpr double kSpineMargin = 0.1;

/// A part of a segment, from 0 at its start to 1 at its end.
struct ClipSpan {
  double begin = 0.0;
  double end = 1.0;

  [[nodiscard]] bool empty() const { return begin >= end; }
};

/// Whether a point in clip space lies behind the near plane and inside the picture with its margin.
[[nodiscard]] inline bool isInPicture(const glm::dvec4& p) {
  constexpr double wide = 1.0 + 2.0 * kSpineMargin;
  return p.z + p.w >= 0.0 && wide * p.w >= std::abs(p.x) && wide * p.w >= std::abs(p.y);
}

/// The part of a → b (clip space) behind the near plane and inside the picture with its margin.
[[nodiscard]] ClipSpan clipSegment(const glm::dvec4& a, const glm::dvec4& b);

}  // namespace limn
