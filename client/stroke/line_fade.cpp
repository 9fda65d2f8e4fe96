// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/line_fade.h"

#include "client/stroke/line_covers.h"

#include "shared/core/disjoint_sets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

namespace limn {
namespace {

/// Limits are at most this share of the whole drawing's extent.
constexpr float kLargestFade = 0.08F;

/// About as wide as strokes mostly are: what is no larger shows as a blot.
constexpr float kBlotPx = 2.5F;

/// 0 up to `belowPx`, 1 from twice that on.
float fade(float extentPx, float belowPx) {
  if (!(belowPx > 0.0F)) return 1.0F;
  const float t = std::clamp(extentPx / belowPx - 1.0F, 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

/// A small outline that lies over larger ones for this share of its extent is as strong as they
/// are, from where it begins to be: they are hidden there. But not a blot: strokes close what it
/// hides.
constexpr float kCoversFrom = 0.1F;
constexpr float kCovers = 0.25F;

/// Ends of outlines, or of inner lines, as near as this continue one another.
constexpr float kJoinPx = 2.5F;

/// A loop several times as long as wide is a fold of the surface, whose outline ends where it turns
/// back. Noise makes a larger fold a row of them; but a row of specks is no line.
constexpr float kFoldWidth = 0.25F;  // of its length, to either side
constexpr float kSmallestFoldPx = 6.0F;
constexpr float kLargestFoldPx = 40.0F;

/// Where a loop that is a fold turns back.
std::optional<std::array<glm::vec2, 2>> foldEnds(
    const SpineSet& spines,
    const SpineSet::Spine& spine) {
  const float extent = spine.extentPx();
  if (extent < kSmallestFoldPx || extent > kLargestFoldPx) return std::nullopt;
  const std::span<const glm::vec2> points(&spines.points[spine.begin], spine.size());
  const auto farthestFrom = [&](const glm::vec2& from) {
    return *std::max_element(points.begin(), points.end(), [&](glm::vec2 a, glm::vec2 b) {
      return glm::distance(a, from) < glm::distance(b, from);
    });
  };
  const glm::vec2 start = farthestFrom(points.front());
  const glm::vec2 end = farthestFrom(start);
  const glm::vec2 along = end - start;
  const float widest = kFoldWidth * glm::dot(along, along);
  for (const glm::vec2& point : points) {
    const glm::vec2 away = point - start;
    if (std::abs(along.x * away.y - along.y * away.x) > widest) return std::nullopt;
  }
  return std::array<glm::vec2, 2>{start, end};
}

/// What inner lines that continue one another are made of. Where a scan is folded or torn, its mesh
/// has creases at every other edge: all of them reach as far as a line does, and are a scribble.
struct Pieces {
  float extentPx = 0.0F;  // their sum
  float count = 0.0F;

  void add(float piecePx) {
    extentPx += piecePx;
    ++count;
  }

  /// How much of a line they are: 0 where they are blots on average.
  [[nodiscard]] float lineness() const { return fade(extentPx / count, kBlotPx); }
};

/// The diagonal of the box around each spine and all those that it continues; of a scribble's parts
/// their own.
std::vector<float> joinedExtents(const SpineSet& spines) {
  struct End {
    glm::vec2 at;
    std::uint32_t spine;
  };

  std::vector<End> ends;
  for (std::uint32_t i = 0; i < spines.spines.size(); ++i) {
    const SpineSet::Spine& spine = spines.spines[i];
    if (isSuggestion(spine.kind)) continue;
    if (spine.closed) {
      if (const auto fold = foldEnds(spines, spine)) {
        ends.push_back({(*fold)[0], i});
        ends.push_back({(*fold)[1], i});
      }
      continue;
    }
    ends.push_back({spines.points[spine.begin], i});
    ends.push_back({spines.points[spine.end - 1], i});
  }
  std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) {
    return a.at.x != b.at.x ? a.at.x < b.at.x
                            : (a.at.y != b.at.y ? a.at.y < b.at.y : a.spine < b.spine);
  });
  DisjointSets lines(spines.spines.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t j = i + 1; j < ends.size() && ends[j].at.x - ends[i].at.x < kJoinPx; ++j) {
      if (isInner(spines.spines[ends[i].spine].kind) ==
              isInner(spines.spines[ends[j].spine].kind) &&
          glm::distance(ends[i].at, ends[j].at) < kJoinPx)
        lines.join(ends[j].spine, ends[i].spine);
    }
  }
  std::vector<SpineSet::Spine> joined(spines.spines);
  std::vector<Pieces> pieces(joined.size());
  for (std::uint32_t i = 0; i < joined.size(); ++i) {
    const std::uint32_t root = lines.rootOf(i);
    joined[root].low = glm::min(joined[root].low, spines.spines[i].low);
    joined[root].high = glm::max(joined[root].high, spines.spines[i].high);
    pieces[root].add(spines.spines[i].extentPx());
  }
  std::vector<float> extents(joined.size());
  for (std::uint32_t i = 0; i < extents.size(); ++i) {
    const std::uint32_t root = lines.rootOf(i);
    const float whole = joined[root].extentPx();
    const SpineSet::Spine& spine = spines.spines[i];
    const float asOne = isInner(spine.kind) ? pieces[root].lineness() : 1.0F;
    extents[i] = glm::mix(spine.extentPx(), whole, asOne);
  }
  return extents;
}

}  // namespace

void fadeLines(
    const SpineSet& spines,
    const StrokeStyle& style,
    const LineScene& scene,
    std::vector<LineFade>& fades) {
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
  const std::vector<float> extents = joinedExtents(spines);
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const SpineSet::Spine& spine = spines.spines[i];
    // Short creases are mostly noise of a scan.
    const float factor = isInner(spine.kind) ? style.creaseFade : 1.0F;
    fades.push_back(
        {fade(extents[i], std::min(factor * style.fadeBelowPx, largest)),
         isSuggestion(spine.kind)
             ? 0.0F
             : fade(spine.extentPx(), std::min(factor * style.fadeHiddenBelowPx, largest))});
  }
  std::vector<std::uint8_t> isSmall(fades.size(), 0);
  for (std::size_t i = 0; i < fades.size(); ++i)
    isSmall[i] = fades[i].visible < 1.0F ? 1 : 0;
  const std::vector<float> covered = coveredLengths(spines, isSmall, scene.camera, scene.viewport);
  for (std::size_t i = 0; i < fades.size(); ++i) {
    if (!(covered[i] > 0.0F)) continue;
    const float extent = spines.spines[i].extentPx();
    const float share = covered[i] / std::max(extent, 1.0F);
    const float strength = (share - kCoversFrom) / (kCovers - kCoversFrom);
    fades[i].visible =
        std::max(fades[i].visible, fade(extent, kBlotPx) * std::clamp(strength, 0.0F, 1.0F));
  }
}

void dropFaded(SpineSet& spines, std::vector<LineFade>& fades) {
  std::uint32_t points = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < spines.spines.size(); ++i) {
    if (!(fades[i].visible > 0.0F) && !(fades[i].hidden > 0.0F)) continue;
    SpineSet::Spine spine = spines.spines[i];
    const std::uint32_t begin = points;
    spines.movePoints(spine.begin, spine.end, begin);
    points += spine.size();
    spine.begin = begin;
    spine.end = points;
    spines.spines[kept] = spine;
    fades[kept] = fades[i];
    ++kept;
  }
  spines.resizePoints(points);
  spines.spines.resize(kept);
  fades.resize(kept);
}

}  // namespace limn
