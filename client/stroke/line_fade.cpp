// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/line_fade.h"

#include <algorithm>

namespace limn {
namespace {

/// Limits are at most this share of the whole drawing's extent.
constexpr float kLargestFade = 0.08F;

/// 0 up to `belowPx`, 1 from twice that on.
float fade(float extentPx, float belowPx) {
  if (!(belowPx > 0.0F)) return 1.0F;
  const float t = std::clamp(extentPx / belowPx - 1.0F, 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

}  // namespace

void fadeLines(const SpineSet& spines, const StrokeStyle& style, std::vector<LineFade>& fades) {
  fades.clear();
  if (spines.spines.empty()) return;
  glm::vec2 low = spines.spines.front().low;
  glm::vec2 high = spines.spines.front().high;
  for (const SpineSet::Spine& spine : spines.spines) {
    low = glm::min(low, spine.low);
    high = glm::max(high, spine.high);
  }
  const float largest = kLargestFade * glm::distance(low, high);
  fades.reserve(spines.spines.size());
  for (const SpineSet::Spine& spine : spines.spines) {
    // Short creases are mostly noise of a scan.
    const float factor = isInner(spine.kind) ? style.creaseFade : 1.0F;
    const float extent = spine.extentPx();
    fades.push_back(
        {fade(extent, std::min(factor * style.fadeBelowPx, largest)),
         isSuggestion(spine.kind)
             ? 0.0F
             : fade(extent, std::min(factor * style.fadeHiddenBelowPx, largest))});
  }
}

void dropFaded(SpineSet& spines, std::vector<LineFade>& fades) {
  std::uint32_t points = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < spines.spines.size(); ++i) {
    if (!(fades[i].visible > 0.0F) && !(fades[i].hidden > 0.0F)) continue;
    SpineSet::Spine spine = spines.spines[i];
    const std::uint32_t begin = points;
    if (begin != spine.begin) {
      const auto move = [&](auto& values) {
        std::copy(values.begin() + spine.begin, values.begin() + spine.end, values.begin() + begin);
      };
      move(spines.points);
      move(spines.exact);
      move(spines.depth);
      move(spines.source);
    }
    points += spine.size();
    spine.begin = begin;
    spine.end = points;
    spines.spines[kept] = spine;
    fades[kept] = fades[i];
    ++kept;
  }
  spines.points.resize(points);
  spines.exact.resize(points);
  spines.depth.resize(points);
  spines.source.resize(points);
  spines.spines.resize(kept);
  fades.resize(kept);
}

}  // namespace limn
