// SPDX-License-Identifier: Apache-2.0
//
// Based on: H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (view
// frustum, surface orientation and screen-space error as criteria); D. Luebke and C. Erikson,
// "View-dependent simplification of arbitrary polygonal environments", SIGGRAPH 1997 (tighter
// bounds where a silhouette may be). Deviations: each split is judged by itself and closure
// follows, and what cannot have a silhouette is kept only as good as depth tests need.
#include "server/session/target_set.h"

#include "shared/core/assert.h"

#include <algorithm>

namespace limn {
namespace {

// How many times the error bound is allowed where no silhouette can be: front-facing surface
// matters to what hides what, back-facing surface hardly to anything.
constexpr double kFrontFactor = 8.0;
constexpr double kBackFactor = 32.0;
// Smooth silhouettes follow vertex normals, which faces just outside the split's own region share
// in.
constexpr double kSmoothSlack = 0.1;

std::uint8_t classOf(double excess) {
  if (excess > 8.0) return kNeededAt8;
  if (excess > 4.0) return kNeededAt4;
  if (excess > 2.0) return kNeededAt2;
  if (excess > 1.0) return kNeededAt1;
  return kNotNeeded;
}

bool touchesLine(const SplitForest& forest, std::size_t split) {
  return forest.features[split] != 0 || forest.cuts[split].left == RingCut::kNoCut ||
         forest.cuts[split].right == RingCut::kNoCut;
}

}  // namespace

std::vector<std::uint8_t> classifySplits(const SplitForest& forest, const View& view) {
  std::vector<std::uint8_t> classes(forest.splitCount(), kNotNeeded);
  const double slack = view.silhouette == protocol::Silhouette::kSmooth ? kSmoothSlack : 0.0;
  for (std::size_t s = 0; s < classes.size(); ++s) {
    const SplitBounds& bounds = forest.bounds[s];
    const glm::dvec3 center(bounds.center);
    const double excess = view.projectedPx(bounds.error, center, bounds.radius) / view.errorPx;
    if (excess <= 1.0 || !view.maySee(center, bounds.radius)) continue;
    // Creases and borders are drawn from every side.
    double allowed = 1.0;
    if (!touchesLine(forest, s)) {
      switch (facingOf(view, bounds, slack)) {
        case Facing::kStraddling:
          break;
        case Facing::kFront:
          allowed = kFrontFactor;
          break;
        case Facing::kBack:
          allowed = kBackFactor;
          break;
      }
    }
    classes[s] = classOf(excess / allowed);
  }
  return classes;
}

std::vector<std::uint8_t> closeOverPrerequisites(
    const SplitForest& forest,
    std::vector<std::uint8_t> classes) {
  LIMN_ASSERT(classes.size() == forest.splitCount());
  const std::uint32_t base = forest.baseVertexCount();
  const auto lower = [&](VertexId v, std::uint8_t to) {
    if (v >= base) classes[v - base] = std::min(classes[v - base], to);
  };
  for (std::size_t s = classes.size(); s-- > 0;) {
    const std::uint8_t mine = classes[s];
    if (mine == kNotNeeded) continue;
    lower(forest.parents[s], mine);
    for (std::uint32_t i = forest.ringBegin[s]; i < forest.ringBegin[s + 1]; ++i) {
      lower(forest.rings[i], mine);
    }
  }
  return classes;
}

TargetSet targetSetOf(
    const SplitForest& forest,
    std::span<const std::uint8_t> classes,
    std::size_t classCount) {
  TargetSet set;
  const std::size_t words = (std::size_t{forest.vertexCount()} + 63) / 64;
  set.classes.assign(classCount, std::vector<std::uint64_t>(words, 0));
  const std::uint32_t base = forest.baseVertexCount();
  for (std::size_t s = 0; s < classes.size(); ++s) {
    if (classes[s] >= classCount) continue;
    const std::size_t v = base + s;
    set.classes[classes[s]][v / 64] |= std::uint64_t{1} << (v % 64);
  }
  return set;
}

TargetSet selectForView(const SplitForest& forest, const View& view) {
  const auto classes = closeOverPrerequisites(forest, classifySplits(forest, view));
  return targetSetOf(forest, classes, kSettledClasses);
}

bool isClosed(const SplitForest& forest, std::span<const std::uint64_t> have) {
  const auto holds = [&](VertexId v) { return (have[v / 64] >> (v % 64) & 1) != 0; };
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
    if (!holds(v)) continue;
    if (!holds(forest.parent(v)) || !std::ranges::all_of(forest.ring(v), holds)) return false;
  }
  return true;
}

}  // namespace limn
