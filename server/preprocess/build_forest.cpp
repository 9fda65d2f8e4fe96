// SPDX-License-Identifier: Apache-2.0
//
// Based on:
//   H. Hoppe, "Progressive meshes", SIGGRAPH 1996;
//   M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997.
// Ours: collapses come in levels of independent sets (shared/progressive/README.md has the rule and
// why it makes single splits selectable), and the survivor of a collapse keeps its place.
#include "server/preprocess/build_forest.h"

#include "server/preprocess/collapse_mesh.h"
#include "server/preprocess/parallel.h"
#include "server/preprocess/split_bounds.h"

#include "shared/codec/draco_codec.h"
#include "shared/core/assert.h"
#include "shared/mesh/closest_point.h"
#include "shared/mesh/feature_edges.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace limn {
namespace {

// Neighbours of a vertex that goes, and of one that stays. Splits of low valence code well; the
// second pair is for meshes that would stall otherwise (needle fans).
struct ValenceLimits {
  std::size_t removed;
  std::size_t kept;
};

constexpr ValenceLimits kUsualLimits{10, 13};
constexpr ValenceLimits kRelaxedLimits{24, 64};  // limits::kMaxRing in the protocol

// A level takes the cheapest of its candidates only: too few make deep closures, all of them make
// poor collapses. Both ends cost bytes (README.md).
constexpr double kCandidateShare = 0.7;

constexpr std::uint32_t kErrorSamples = 4000;
constexpr std::uint32_t kMaxLevels = 60;

// One level of collapses, by the input's vertex numbers.
struct Level {
  std::vector<HalfEdgeCollapse> collapses;
  std::vector<SplitBounds> bounds;       // parallel to collapses
  std::vector<std::uint32_t> ringBegin;  // parallel, + 1
  std::vector<std::uint32_t> rings;      // of the kept vertex after the whole level
  std::vector<bool> isPath;              // parallel: the kept vertex is on a border
  LevelSummary finer;                    // the mesh that the level's splits lead to
};

struct Candidate {
  float cost;
  std::uint32_t vertex;

  friend bool operator<(const Candidate& a, const Candidate& b) {
    return a.cost != b.cost ? a.cost < b.cost : a.vertex < b.vertex;
  }
};

class ForestBuilder {
 public:
  ForestBuilder(CollapseMesh mesh, const ForestOptions& options)
      : mesh_(std::move(mesh)),
        options_(options),
        costs_(options.cost, mesh_),
        bounds_(mesh_),
        lockedIn_(vertexCount(), 0),
        parentIn_(vertexCount(), 0),
        ancestor_(vertexCount()) {
    std::iota(ancestor_.begin(), ancestor_.end(), 0U);
    present_ = ancestor_;
    fullPositions_ = mesh_.positions();
  }

  void simplify() {
    ValenceLimits limits = kUsualLimits;
    LevelSummary current = summary();
    while (mesh_.aliveFaces() > options_.baseFaces && levels_.size() < kMaxLevels) {
      const std::size_t before = present_.size();
      Level level = collapseLevel(limits);
      if (level.collapses.empty()) {
        if (limits.kept == kRelaxedLimits.kept) break;
        limits = kRelaxedLimits;
        continue;
      }
      if (level.collapses.size() < before / 50) limits = kRelaxedLimits;
      level.finer = current;
      mesh_.compact();
      std::erase_if(present_, [&](std::uint32_t v) { return ancestor_[v] != v; });
      recordRings(level);
      levels_.push_back(std::move(level));
      current = summary();
    }
    base_ = current;
  }

  [[nodiscard]] const CollapseMesh& mesh() const { return mesh_; }

  [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }  // fine to coarse

  [[nodiscard]] const std::vector<std::uint32_t>& present() const { return present_; }

  [[nodiscard]] const LevelSummary& base() const { return base_; }

 private:
  [[nodiscard]] std::uint32_t vertexCount() const {
    return static_cast<std::uint32_t>(mesh_.positions().size());
  }

  // The cheapest collapse of v that is allowed now; parents used in this level do not count.
  [[nodiscard]] std::optional<HalfEdgeCollapse>
  bestCollapse(std::uint32_t v, const ValenceLimits& limits, double* cost = nullptr) const {
    thread_local std::vector<std::uint32_t> ring;
    thread_local std::vector<std::pair<double, std::uint32_t>> targets;
    mesh_.mesh().ring(v, ring);
    if (ring.empty() || ring.size() > limits.removed) return std::nullopt;
    targets.clear();
    const auto level = static_cast<std::uint8_t>(levels_.size() + 1);
    for (const std::uint32_t u : ring) {
      if (parentIn_[u] != level) targets.emplace_back(costs_.cost(mesh_, v, u), u);
    }
    std::sort(targets.begin(), targets.end());
    for (const auto& [targetCost, u] : targets) {
      const auto collapse = mesh_.plan(v, u);
      if (!collapse || collapse->ringSize > limits.kept) continue;
      if (cost != nullptr) *cost = targetCost;
      return collapse;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::vector<Candidate> candidates(const ValenceLimits& limits) const {
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
    std::sort(result.begin(), result.end());
    return result;
  }

  // Rule RING (shared/progressive/README.md): removed vertices are pairwise not adjacent, since a
  // removal locks its ring; each vertex is parent once; parents are ring vertices, hence locked.
  [[nodiscard]] Level collapseLevel(const ValenceLimits& limits) {
    Level level;
    const std::vector<Candidate> sorted = candidates(limits);
    const auto stamp = static_cast<std::uint8_t>(levels_.size() + 1);
    const auto share =
        static_cast<std::size_t>(std::ceil(kCandidateShare * static_cast<double>(sorted.size())));
    std::vector<std::uint32_t> ring;
    for (std::size_t i = 0; i < share && mesh_.aliveFaces() > options_.baseFaces; ++i) {
      const std::uint32_t v = sorted[i].vertex;
      if (lockedIn_[v] == stamp) continue;
      const auto collapse = bestCollapse(v, limits);
      if (!collapse) continue;
      mesh_.mesh().ring(v, ring);
      for (const std::uint32_t x : ring)
        lockedIn_[x] = stamp;
      lockedIn_[v] = stamp;
      parentIn_[collapse->kept] = stamp;
      level.bounds.push_back(bounds_.beforeCollapse(mesh_, *collapse));
      level.collapses.push_back(*collapse);
      mesh_.collapse(*collapse);
      costs_.collapsed(*collapse);
      ancestor_[v] = collapse->kept;
    }
    return level;
  }

  void recordRings(Level& level) const {
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
  [[nodiscard]] LevelSummary summary() {
    LevelSummary result{static_cast<std::uint32_t>(present_.size()), mesh_.aliveFaces(), 0.0};
    const std::uint32_t stride = std::max(1U, vertexCount() / kErrorSamples);
    double sum = 0.0;
    std::uint32_t samples = 0;
    for (std::uint32_t v = 0; v < vertexCount(); v += stride) {
      std::uint32_t a = v;
      while (ancestor_[a] != a)
        a = ancestor_[a];
      ancestor_[v] = a == v ? v : a;  // a shorter way next time; only "is it itself" matters else
      const HalfEdgeMesh& halfEdges = mesh_.mesh();
      const auto at = [&](std::uint32_t x) { return glm::dvec3(fullPositions_[x]); };
      double best = glm::dot(at(v) - at(a), at(v) - at(a));
      const HalfEdgeId first = halfEdges.outgoing[a];
      for (HalfEdgeId h = first; h != kNone && best > 0.0;) {
        const glm::dvec3 offset = closestPointOnTriangle(
                                      at(v),
                                      at(a),
                                      at(halfEdges.target(h)),
                                      at(halfEdges.origin(HalfEdgeMesh::prev(h)))) -
                                  at(v);
        best = std::min(best, glm::dot(offset, offset));
        h = halfEdges.rotateCcw(h);
        if (h == first) break;
      }
      sum += best;
      ++samples;
    }
    result.rmsError = samples == 0 ? 0.0 : std::sqrt(sum / samples);
    return result;
  }

  CollapseMesh mesh_;
  ForestOptions options_;
  CostModel costs_;
  BoundsGatherer bounds_;
  std::vector<Level> levels_;
  LevelSummary base_;
  std::vector<std::uint8_t> lockedIn_;   // level in which a vertex was locked last
  std::vector<std::uint8_t> parentIn_;   // … was a parent last
  std::vector<std::uint32_t> ancestor_;  // itself while present, else some present-er ancestor
  std::vector<std::uint32_t> present_;
  std::vector<glm::ivec3> fullPositions_;
};

// The base mesh, its vertices renumbered in the order of `present`.
TriangleMesh extractBase(const ForestBuilder& builder, const Grid& grid) {
  const CollapseMesh& mesh = builder.mesh();
  std::vector<std::uint32_t> number(mesh.positions().size(), kNone);
  TriangleMesh base;
  base.grid = grid;
  for (const std::uint32_t v : builder.present()) {
    number[v] = static_cast<std::uint32_t>(base.positions.size());
    base.positions.push_back(mesh.positions()[v]);
  }
  for (const glm::uvec3& t : mesh.mesh().triangles()) {
    base.triangles.emplace_back(number[t.x], number[t.y], number[t.z]);
  }
  return base;
}

// Gives every vertex its permanent id: base in Draco's order, then level by level, coarse to fine,
// by the parent's id within a level, so that both run upwards together.
std::vector<VertexId> numberVertices(
    const ForestBuilder& builder,
    std::span<const std::uint32_t> baseOrder,
    SplitForest& forest) {
  std::vector<VertexId> id(builder.mesh().positions().size(), kNone);
  VertexId next = 0;
  for (const std::uint32_t b : baseOrder)
    id[builder.present()[b]] = next++;
  forest.levelBegin = {0, next};
  for (auto level = builder.levels().rbegin(); level != builder.levels().rend(); ++level) {
    std::vector<std::pair<VertexId, std::uint32_t>> byParent;
    for (const HalfEdgeCollapse& c : level->collapses)
      byParent.emplace_back(id[c.kept], c.removed);
    std::sort(byParent.begin(), byParent.end());
    for (const auto& [parent, v] : byParent)
      id[v] = next++;
    forest.levelBegin.push_back(next);
  }
  return id;
}

void recordSplits(const ForestBuilder& builder, std::span<const VertexId> id, SplitForest& forest) {
  const std::uint32_t base = forest.baseVertexCount();
  const std::uint32_t splits = forest.splitCount();
  forest.parents.resize(splits);
  forest.cuts.resize(splits);
  forest.features.resize(splits);
  forest.bounds.resize(splits);
  forest.ringBegin.assign(1, 0);

  struct Source {
    const Level* level;
    std::uint32_t index;
  };

  std::vector<Source> sources(splits);
  for (const Level& level : builder.levels()) {
    for (std::uint32_t i = 0; i < level.collapses.size(); ++i) {
      sources[id[level.collapses[i].removed] - base] = {&level, i};
    }
  }
  for (std::uint32_t s = 0; s < splits; ++s) {
    const auto& [level, i] = sources[s];
    const HalfEdgeCollapse& collapse = level->collapses[i];
    const auto ringStart = static_cast<std::ptrdiff_t>(forest.rings.size());
    for (std::uint32_t r = level->ringBegin[i]; r < level->ringBegin[i + 1]; ++r) {
      forest.rings.push_back(id[level->rings[r]]);
    }
    const auto ringFirst = forest.rings.begin() + ringStart;
    if (!level->isPath[i])
      std::rotate(ringFirst, std::min_element(ringFirst, forest.rings.end()), forest.rings.end());
    const auto indexOf = [&](std::uint32_t side) {
      if (side == kNone) return RingCut::kNoCut;
      const auto found = std::find(forest.rings.begin() + ringStart, forest.rings.end(), id[side]);
      LIMN_ASSERT(found != forest.rings.end());
      return static_cast<std::uint8_t>(found - (forest.rings.begin() + ringStart));
    };
    forest.cuts[s] = {indexOf(collapse.left), indexOf(collapse.right)};
    forest.parents[s] = id[collapse.kept];
    forest.features[s] = collapse.features | (level->isPath[i] ? kSplitParentOnBorder : 0);
    forest.bounds[s] = level->bounds[i];
    forest.ringBegin.push_back(static_cast<std::uint32_t>(forest.rings.size()));
  }
}

// Features of the decoded base mesh's half-edges, looked up in the simplified one.
std::vector<std::uint8_t>
baseFeatures(const ForestBuilder& builder, std::span<const VertexId> id, const TriangleMesh& base) {
  const CollapseMesh& mesh = builder.mesh();
  std::vector<std::uint32_t> original(base.positions.size());
  for (const std::uint32_t v : builder.present())
    original[id[v]] = v;
  std::vector<std::uint8_t> features;
  for (const glm::uvec3& t : base.triangles) {
    for (int k = 0; k < 3; ++k) {
      const HalfEdgeId h = mesh.mesh().find(original[t[k]], original[t[(k + 1) % 3]]);
      features.push_back(h == kNone ? 0 : mesh.features()[h]);
    }
  }
  return features;
}

}  // namespace

Result<BuiltForest> buildForest(const TriangleMesh& mesh, const ForestOptions& options) {
  auto full =
      HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), mesh.triangles);
  if (!full) return tl::unexpected(full.error());
  auto collapsible =
      CollapseMesh::build(mesh, findCreases(*full, mesh.positions, options.creaseAngleDegrees));
  if (!collapsible) return tl::unexpected(collapsible.error());

  ForestBuilder builder(std::move(*collapsible), options);
  builder.simplify();

  BuiltForest result;
  SplitForest& forest = result.forest;
  const TriangleMesh base = extractBase(builder, mesh.grid);
  auto draco = encodeDraco(base);
  if (!draco) return tl::unexpected(draco.error().within("base mesh"));
  auto decoded = decodeDraco(
      draco->bytes,
      static_cast<std::uint32_t>(base.positions.size()),
      static_cast<std::uint32_t>(base.triangles.size()));
  if (!decoded) return tl::unexpected(decoded.error().within("base mesh"));

  forest.grid = mesh.grid;
  const std::vector<VertexId> id = numberVertices(builder, draco->order, forest);
  forest.positions.resize(mesh.positions.size());
  for (std::size_t v = 0; v < id.size(); ++v)
    forest.positions[id[v]] = mesh.positions[v];
  forest.baseTriangles = std::move(decoded->triangles);
  forest.baseFeatures =
      baseFeatures(builder, id, {mesh.grid, decoded->positions, forest.baseTriangles});
  forest.triangles.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles)
    forest.triangles.emplace_back(id[t.x], id[t.y], id[t.z]);
  recordSplits(builder, id, forest);

  result.baseDraco = std::move(draco->bytes);
  result.levels.push_back(builder.base());
  for (auto level = builder.levels().rbegin(); level != builder.levels().rend(); ++level) {
    result.levels.push_back(level->finer);
  }
  return result;
}

}  // namespace limn
