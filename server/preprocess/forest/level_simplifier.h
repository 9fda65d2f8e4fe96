// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/forest/build_forest.h"
#include "server/preprocess/forest/collapse_cost.h"
#include "server/preprocess/forest/collapse_mesh.h"
#include "server/preprocess/forest/packing_queue.h"
#include "server/preprocess/forest/split_bounds.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace limn {

/// One level of collapses, by the input's vertex numbers.
struct CollapseLevel {
  std::vector<HalfEdgeCollapse> collapses;
  std::vector<SplitBounds> bounds;       // parallel to collapses
  std::vector<std::uint32_t> ringBegin;  // parallel, + 1
  std::vector<std::uint32_t> rings;      // of the kept vertex after the whole level
  std::vector<bool> isPath;              // parallel: the kept vertex is on a border
  std::vector<glm::ivec3> moves;  // parallel: where kept vertices stood, less where they stand
  LevelSummary finer;             // the mesh that the level's splits lead to
};

/// What a collapse may do. Splits of low valence code well, faces that turn little keep contours
/// clean; later stages are for meshes that would stall otherwise.
struct CollapseLimits {
  std::size_t removedValence;  // neighbours of a vertex that goes
  std::size_t keptValence;     // … of one that stays, afterwards
  double leastNormalCosine;    // between a face's normal before and after
};

/// Simplifies a mesh level by level under rule RING (shared/progressive/README.md), until it has
/// options.baseFaces faces or no collapse is left.
class LevelSimplifier {
 public:
  LevelSimplifier(CollapseMesh mesh, const ForestOptions& options);

  void run();

  [[nodiscard]] const CollapseMesh& mesh() const { return mesh_; }

  [[nodiscard]] const std::vector<CollapseLevel>& levels() const { return levels_; }  // fine first

  [[nodiscard]] const std::vector<std::uint32_t>& present() const { return present_; }

  [[nodiscard]] const LevelSummary& base() const { return base_; }

 private:
  struct Candidate {
    float cost;
    std::uint32_t vertex;
  };

  [[nodiscard]] std::uint32_t vertexCount() const;
  [[nodiscard]] double squaredEdge(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] double smallEdge2() const;
  [[nodiscard]] std::optional<HalfEdgeCollapse>
  bestCollapse(std::uint32_t v, const CollapseLimits& limits, double* cost) const;
  [[nodiscard]] std::vector<Candidate> candidates(const CollapseLimits& limits) const;
  [[nodiscard]] static std::size_t shareOf(std::span<const Candidate> sorted);
  [[nodiscard]] CollapseLevel collapseLevel(const CollapseLimits& limits);
  void enqueue(std::span<const Candidate> bucket);
  void collapseIfAllowed(std::uint32_t v, const CollapseLimits& limits, CollapseLevel& level);
  /// Whether another collapse of the level had to do with a feature that this one says something
  /// of, the edge between their parents: clients may apply the two in either order.
  [[nodiscard]] bool sharesFeature(const HalfEdgeCollapse& collapse) const;
  void lockAround(std::uint32_t v);

  [[nodiscard]] bool isLocked(std::uint32_t v) const { return lockedIn_[v] == stamp_; }

  void recordRings(CollapseLevel& level) const;
  [[nodiscard]] LevelSummary summary();

  CollapseMesh mesh_;
  std::vector<glm::ivec3> full_;  // positions before any collapse; empty where none moves anything
  ForestOptions options_;
  CostModel costs_;
  BoundsGatherer bounds_;
  PackingQueue queue_;
  std::vector<CollapseLevel> levels_;
  LevelSummary base_;
  std::uint8_t stamp_ = 0;                           // of the level under way
  double smallEdge2_ = 0.0;                          // edges below are small in it
  float ceiling_ = 0.0F;                             // what a collapse of that level may cost
  std::vector<std::uint8_t> lockedIn_;               // level in which a vertex was locked last
  std::vector<std::uint8_t> parentIn_;               // … was a parent last
  std::vector<std::array<std::uint32_t, 2>> sides_;  // … of which collapse: left and right
  std::vector<std::uint32_t> ancestor_;  // itself while present, else some present-er ancestor
  std::vector<std::uint32_t> present_;
};

}  // namespace limn
