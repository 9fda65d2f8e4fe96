// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   H. Hoppe, "Progressive meshes", SIGGRAPH 1996;
//   M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997.
// Ours: collapses come in levels of independent sets, packed tightly so that levels are few and
// prerequisites shallow, and the survivor of a collapse keeps its place unless placement moves it.
#include "server/preprocess/forest/level_simplifier.h"

#include "server/preprocess/forest/parallel.h"

#include "shared/mesh/closest_point.h"
#include "shared/progressive/vertex_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace limn {
namespace {

// The last one's valences are limits::kMaxRing in the protocol.
constexpr std::array<CollapseLimits, 4> kStages = {
    {{10, 13, 0.85}, {10, 13, 0.7}, {12, 16, 0.5}, {24, 64, 0.2}}};

// A level that removes less than this part of the vertices goes on to the next stage.
constexpr std::size_t kStallShare = 6;

// A level takes the cheapest of its candidates only: few make many levels and deep closures, all of
// them make poor collapses. They are tried in buckets of rising cost, tightly packed within each.
constexpr double kCandidateShare = 0.8;
// Nor does it take collapses that cost this many times what the cheapest quarter does: flat regions
// go on for some levels before edges and corners are touched. (Costs go with squared distances.)
constexpr float kCostSpread = 1000.0F;
constexpr std::size_t kBuckets = 4;

// Where a vertex's edges are all shorter than this part of the mesh's usual edge, faces may turn as
// in the last stage: small shells beside a large body shrink to tetrahedra early, or they would be
// all that is left of the mesh in the end.
constexpr double kSmallEdge = 0.35;

constexpr std::uint32_t kErrorSamples = 4000;
constexpr std::size_t kMaxLevels = 60;

}  // namespace

LevelSimplifier::LevelSimplifier(CollapseMesh mesh, const ForestOptions& options)
    : mesh_(std::move(mesh)),
      options_(options),
      costs_(options.cost, mesh_),
      bounds_(mesh_, options.placement),
      queue_(vertexCount()),
      lockedIn_(vertexCount(), 0),
      parentIn_(vertexCount(), 0),
      sides_(vertexCount()),
      ancestor_(vertexCount()) {
  std::iota(ancestor_.begin(), ancestor_.end(), 0U);
  present_ = ancestor_;
  if (options_.placement == Placement::kVolume) full_ = mesh_.positions();
}

std::uint32_t LevelSimplifier::vertexCount() const {
  return static_cast<std::uint32_t>(mesh_.positions().size());
}

void LevelSimplifier::run() {
  std::size_t stage = 0;
  LevelSummary current = summary();
  while (mesh_.aliveFaces() > options_.baseFaces && levels_.size() < kMaxLevels) {
    const std::size_t before = present_.size();
    CollapseLevel level = collapseLevel(kStages[stage]);
    if (level.collapses.size() < before / kStallShare || level.collapses.empty()) {
      if (level.collapses.empty() && stage + 1 == kStages.size()) break;
      stage = std::min(stage + 1, kStages.size() - 1);
    }
    if (level.collapses.empty()) continue;
    level.finer = current;
    mesh_.compact();
    std::erase_if(present_, [&](std::uint32_t v) { return ancestor_[v] != v; });
    recordRings(level);
    levels_.push_back(std::move(level));
    current = summary();
  }
  base_ = current;
}

double LevelSimplifier::squaredEdge(std::uint32_t a, std::uint32_t b) const {
  const glm::dvec3 edge = glm::dvec3(mesh_.positions()[a]) - glm::dvec3(mesh_.positions()[b]);
  return glm::dot(edge, edge);
}

// kSmallEdge of the median edge, squared; of one edge a vertex.
double LevelSimplifier::smallEdge2() const {
  std::vector<double> edges;
  for (const std::uint32_t v : present_) {
    const HalfEdgeId h = mesh_.mesh().outgoing[v];
    if (h != kNone) edges.push_back(squaredEdge(v, mesh_.mesh().target(h)));
  }
  if (edges.empty()) return 0.0;
  const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2);
  std::nth_element(edges.begin(), middle, edges.end());
  return kSmallEdge * kSmallEdge * *middle;
}

// The cheapest collapse of v that is allowed now; parents used in this level do not count.
std::optional<HalfEdgeCollapse>
LevelSimplifier::bestCollapse(std::uint32_t v, const CollapseLimits& limits, double* cost) const {
  struct Target {
    double cost;
    std::uint32_t parent;
    glm::ivec3 position;  // of the parent afterwards
  };

  thread_local std::vector<std::uint32_t> ring;
  thread_local std::vector<Target> targets;
  mesh_.mesh().ring(v, ring);
  if (ring.empty() || ring.size() > limits.removedValence) return std::nullopt;
  targets.clear();
  const VertexCost vertexCost = costs_.around(mesh_, v);
  bool isSmall = true;
  for (const std::uint32_t u : ring) {
    isSmall = isSmall && squaredEdge(v, u) < smallEdge2_;
    if (parentIn_[u] == stamp_) continue;
    targets.push_back({costs_.cost(mesh_, vertexCost, u), u, mesh_.positions()[u]});
    if (options_.placement == Placement::kSubset) continue;
    const auto placed = costs_.place(mesh_, vertexCost, costs_.formsAround(mesh_, u));
    if (placed) targets.push_back({placed->cost, u, placed->position});
  }
  // Of each parent at one cost the place it has comes first.
  std::stable_sort(targets.begin(), targets.end(), [](const Target& a, const Target& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.parent < b.parent;
  });
  const double leastCosine = isSmall ? kStages.back().leastNormalCosine : limits.leastNormalCosine;
  for (const auto& [targetCost, u, position] : targets) {
    const auto collapse = mesh_.plan(v, u, position, leastCosine);
    if (!collapse || collapse->ringSize > limits.keptValence) continue;
    *cost = targetCost;
    return collapse;
  }
  return std::nullopt;
}

std::vector<LevelSimplifier::Candidate> LevelSimplifier::candidates(
    const CollapseLimits& limits) const {
  std::vector<float> cheapest(present_.size(), -1.0F);
  parallelFor(
      static_cast<std::uint32_t>(present_.size()),
      options_.threads,
      [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
          double cost = 0.0;
          if (bestCollapse(present_[i], limits, &cost)) cheapest[i] = static_cast<float>(cost);
        }
      });
  std::vector<Candidate> result;
  for (std::size_t i = 0; i < present_.size(); ++i) {
    if (cheapest[i] >= 0.0F) result.push_back({cheapest[i], present_[i]});
  }
  std::sort(result.begin(), result.end(), [](const Candidate& a, const Candidate& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.vertex < b.vertex;
  });
  return result;
}

// How many of the candidates, from the cheapest, a level may take.
std::size_t LevelSimplifier::shareOf(std::span<const Candidate> sorted) {
  auto share =
      static_cast<std::size_t>(std::ceil(kCandidateShare * static_cast<double>(sorted.size())));
  if (share == 0) return 0;
  const float most = kCostSpread * sorted[sorted.size() / 4].cost;
  while (sorted[share - 1].cost > most)
    --share;
  return share;
}

CollapseLevel LevelSimplifier::collapseLevel(const CollapseLimits& limits) {
  CollapseLevel level;
  ++stamp_;
  smallEdge2_ = smallEdge2();
  const std::vector<Candidate> sorted = candidates(limits);
  const std::size_t share = shareOf(sorted);
  if (share == 0) return level;
  ceiling_ = sorted[share - 1].cost;
  for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) {
    const std::size_t begin = share * bucket / kBuckets;
    enqueue(std::span(sorted).subspan(begin, share * (bucket + 1) / kBuckets - begin));
    while (const auto v = queue_.pop()) {
      if (mesh_.aliveFaces() > options_.baseFaces) collapseIfAllowed(*v, limits, level);
    }
  }
  return level;
}

void LevelSimplifier::enqueue(std::span<const Candidate> bucket) {
  std::vector<std::uint32_t> ring;
  for (auto candidate = bucket.rbegin(); candidate != bucket.rend(); ++candidate) {
    if (isLocked(candidate->vertex)) continue;
    mesh_.mesh().ring(candidate->vertex, ring);
    const auto unlocked =
        std::count_if(ring.begin(), ring.end(), [&](std::uint32_t x) { return !isLocked(x); });
    queue_.push(candidate->vertex, static_cast<std::uint32_t>(unlocked));
  }
}

// Rule RING: removed vertices are pairwise not adjacent, since a removal locks its ring; each
// vertex is parent once; parents are ring vertices, hence locked.
void LevelSimplifier::collapseIfAllowed(
    std::uint32_t v,
    const CollapseLimits& limits,
    CollapseLevel& level) {
  if (isLocked(v)) return;
  double cost = 0.0;
  const auto collapse = bestCollapse(v, limits, &cost);
  // The cheap parents may be taken: then this vertex waits for the next level.
  if (!collapse || static_cast<float>(cost) > ceiling_ || sharesFeature(*collapse)) return;
  lockAround(v);
  parentIn_[collapse->kept] = stamp_;
  sides_[collapse->kept] = {collapse->left, collapse->right};
  level.bounds.push_back(bounds_.beforeCollapse(mesh_, *collapse));
  level.collapses.push_back(*collapse);
  level.moves.push_back(mesh_.positions()[collapse->kept] - collapse->position);
  mesh_.collapse(*collapse);
  costs_.collapsed(*collapse);
  ancestor_[v] = collapse->kept;
}

bool LevelSimplifier::sharesFeature(const HalfEdgeCollapse& collapse) const {
  const std::uint8_t features = collapse.features | collapse.seams;
  const auto shares = [&](std::uint32_t side, std::uint8_t edges) {
    if (side == kNone || (features & edges) == 0 || parentIn_[side] != stamp_) return false;
    return sides_[side][0] == collapse.kept || sides_[side][1] == collapse.kept;
  };
  return shares(collapse.left, kSplitEdgeUL | kSplitEdgeVL) ||
         shares(collapse.right, kSplitEdgeUR | kSplitEdgeVR);
}

void LevelSimplifier::lockAround(std::uint32_t v) {
  thread_local std::vector<std::uint32_t> ring;
  thread_local std::vector<std::uint32_t> beyond;
  mesh_.mesh().ring(v, ring);
  for (const std::uint32_t x : ring) {
    if (isLocked(x)) continue;
    lockedIn_[x] = stamp_;
    mesh_.mesh().ring(x, beyond);
    for (const std::uint32_t y : beyond)
      queue_.neighbourLocked(y);
  }
  lockedIn_[v] = stamp_;
}

void LevelSimplifier::recordRings(CollapseLevel& level) const {
  std::vector<std::uint32_t> ring;
  level.ringBegin.push_back(0);
  for (const HalfEdgeCollapse& collapse : level.collapses) {
    mesh_.mesh().ring(collapse.kept, ring);
    level.rings.insert(level.rings.end(), ring.begin(), ring.end());
    level.ringBegin.push_back(static_cast<std::uint32_t>(level.rings.size()));
    level.isPath.push_back(mesh_.mesh().isBorderVertex(collapse.kept));
  }
}

// Distance from a sample of the full mesh's vertices to the faces around their ancestors.
LevelSummary LevelSimplifier::summary() {
  LevelSummary result{static_cast<std::uint32_t>(present_.size()), mesh_.aliveFaces(), 0.0};
  const std::uint32_t stride = std::max(1U, vertexCount() / kErrorSamples);
  double sum = 0.0;
  std::uint32_t samples = 0;
  for (std::uint32_t v = 0; v < vertexCount(); v += stride) {
    std::uint32_t a = v;
    while (ancestor_[a] != a)
      a = ancestor_[a];
    ancestor_[v] = a == v ? v : a;  // a shorter way next time; only "is it itself" matters else
    const auto at = [&](std::uint32_t x) { return glm::dvec3(mesh_.positions()[x]); };
    const glm::dvec3 sample(full_.empty() ? mesh_.positions()[v] : full_[v]);
    double best = glm::dot(sample - at(a), sample - at(a));
    mesh_.forEachFace(a, [&](HalfEdgeId, std::uint32_t b, std::uint32_t c) {
      if (best == 0.0) return;
      const glm::dvec3 offset = closestPointOnTriangle(sample, at(a), at(b), at(c)) - sample;
      best = std::min(best, glm::dot(offset, offset));
    });
    sum += best;
    ++samples;
  }
  result.rmsError = samples == 0 ? 0.0 : std::sqrt(sum / samples);
  return result;
}

}  // namespace limn
