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
#include <array>
#include <cmath>

namespace limn {
namespace {

// Chosen by measurement on scans and CAD parts (README.md): the 95th percentile of the distance
// between a settled client's visible silhouettes and the full mesh's stays within the bound.
//
// Where a silhouette may be, the surface keeps to half the bound.
constexpr double kStraddleFactor = 0.5;
// There the silhouette also moves *along* the surface when splits come in. All normals of a patch
// are within 2θ of perpendicular to the view, θ the half-angle of its cone, so that a patch of
// radius r is foreshortened to r·sin 2θ; of that, this much is how far silhouettes were seen to be
// off.
constexpr double kSmoothWander = 0.1;
constexpr double kEdgesWander = 0.15;  // polygonal silhouettes zigzag
// How many times the bound is allowed where no silhouette can be: front-facing surface matters to
// what hides what, back-facing surface hardly to anything.
constexpr double kFrontFactor = 6.0;
constexpr double kBackFactor = 24.0;

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

std::vector<SplitCone> smoothConesOf(const SplitForest& forest) {
  std::vector<glm::dvec3> normals(forest.vertexCount(), glm::dvec3(0.0));
  for (const glm::uvec3& t : forest.triangles) {
    const std::array<glm::dvec3, 3> p = {
        glm::dvec3(forest.positions[t.x]),
        glm::dvec3(forest.positions[t.y]),
        glm::dvec3(forest.positions[t.z])};
    const glm::dvec3 area = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double length = glm::length(area);
    if (length == 0.0) continue;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 a = glm::normalize(p[(k + 1) % 3] - p[k]);
      const glm::dvec3 b = glm::normalize(p[(k + 2) % 3] - p[k]);
      normals[t[k]] += area / length * std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
    }
  }
  std::vector<SplitCone> cones(forest.splitCount());
  for (std::size_t s = 0; s < cones.size(); ++s) {
    const SplitBounds& bounds = forest.bounds[s];
    SplitCone& cone = cones[s];
    cone = {bounds.coneAxis, bounds.coneCos};
    const glm::dvec3 axis(bounds.coneAxis);
    const auto widen = [&](VertexId v) {
      const double length = glm::length(normals[v]);
      const double cosine = length == 0.0 ? -1.0 : glm::dot(normals[v], axis) / length;
      cone.cos = std::min(cone.cos, static_cast<float>(cosine));
    };
    widen(forest.baseVertexCount() + static_cast<VertexId>(s));
    widen(forest.parents[s]);
    for (std::uint32_t i = forest.ringBegin[s]; i < forest.ringBegin[s + 1]; ++i) {
      widen(forest.rings[i]);
    }
  }
  return cones;
}

std::vector<std::uint8_t> classifySplits(
    const SplitForest& forest,
    const View& view,
    std::span<const SplitCone> smoothCones) {
  std::vector<std::uint8_t> classes(forest.splitCount(), kNotNeeded);
  const bool smooth =
      view.silhouette == protocol::Silhouette::kSmooth && smoothCones.size() == classes.size();
  const double wander =
      view.silhouette == protocol::Silhouette::kSmooth ? kSmoothWander : kEdgesWander;
  for (std::size_t s = 0; s < classes.size(); ++s) {
    const SplitBounds& bounds = forest.bounds[s];
    const glm::dvec3 center(bounds.center);
    if (!view.maySee(center, bounds.radius)) continue;
    const SplitCone cone = smooth ? smoothCones[s] : SplitCone{bounds.coneAxis, bounds.coneCos};
    const double perUnit = view.projectedPx(1.0, center, bounds.radius) / view.errorPx;
    const double moved = bounds.error > 0.0F ? bounds.error * perUnit : 0.0;
    double excess = moved;
    switch (facingOf(view, bounds, cone)) {
      case Facing::kStraddling: {
        // sin 2θ of the cone's half-angle θ, 1 from 45° on.
        const double cosHalf = std::clamp(static_cast<double>(cone.cos), 0.70710678, 1.0);
        const double turn = 2.0 * cosHalf * std::sqrt(1.0 - cosHalf * cosHalf);
        excess = std::max(moved / kStraddleFactor, wander * turn * bounds.radius * perUnit);
        break;
      }
      case Facing::kFront:
        // Creases and borders are drawn from every side.
        if (!touchesLine(forest, s)) excess /= kFrontFactor;
        break;
      case Facing::kBack:
        if (!touchesLine(forest, s)) excess /= kBackFactor;
        break;
    }
    classes[s] = classOf(excess);
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
    forest.forEachPrerequisite(base + static_cast<VertexId>(s), [&](VertexId v) {
      lower(v, mine);
    });
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
  for (std::size_t c = 1; c < classCount; ++c) {
    for (std::size_t word = 0; word < words; ++word)
      set.classes[c][word] |= set.classes[c - 1][word];
  }
  return set;
}

TargetSet
selectForView(const SplitForest& forest, const View& view, std::span<const SplitCone> smoothCones) {
  const auto classes = closeOverPrerequisites(forest, classifySplits(forest, view, smoothCones));
  return targetSetOf(forest, classes, kSettledClasses);
}

bool isClosed(const SplitForest& forest, std::span<const std::uint64_t> have) {
  const auto holds = [&](VertexId v) { return (have[v / 64] >> (v % 64) & 1) != 0; };
  for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
    if (!holds(v)) continue;
    bool whole = true;
    forest.forEachPrerequisite(v, [&](VertexId w) { whole = whole && holds(w); });
    if (!whole) return false;
  }
  return true;
}

}  // namespace limn
