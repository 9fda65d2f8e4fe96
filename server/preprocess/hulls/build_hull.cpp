// SPDX-License-Identifier: Apache-2.0
// Based on: P. Sander, X. Gu, S. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping", SIGGRAPH
// 2000, section 3. Ours: positions are integers, and constraints are checked on them exactly; faces
// may not turn too far, nor cross others.
#include "server/preprocess/hulls/build_hull.h"

#include "server/preprocess/hulls/crossing_guard.h"
#include "server/preprocess/hulls/hull_mesh.h"
#include "server/preprocess/hulls/hull_placement.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

namespace limn {
namespace {

/// What a collapse may do.
struct Strictness {
  PlacementRules rules;
  bool mayCross = false;
  double largestGain = 0.0;  // share of the mesh's volume that one collapse may add
};

constexpr double kSomeGain = 0.01;
constexpr double kAnyGain = std::numeric_limits<double>::infinity();

/// Strictest first: each is tried when the one before has nothing left. The last one is taken back
/// unless it gets down to the base: a model of many parts or handles, which cannot, would lose its
/// shape for nothing.
constexpr Strictness kStrictness[] = {
    {{.minNormalDot = 0.2}, false, kSomeGain},
    {{.minNormalDot = 0.2}, true, kSomeGain},
    {{.minNormalDot = -1.0}, true, kSomeGain},
    {{.minNormalDot = -1.0}, true, kAnyGain}};

class HullBuilder {
 public:
  HullBuilder(HullMesh mesh, double volume6)
      : mesh_(std::move(mesh)),
        volume6_(volume6),
        guard_(mesh_),
        edges_(mesh_.links().origins.size()),
        versions_(mesh_.positions().size(), 0) {}

  /// Collapses while there are more than `faces`.
  void run(std::uint32_t faces) {
    for (const Strictness& strictness : kStrictness) {
      const bool isLast = &strictness == std::end(kStrictness) - 1;
      std::optional<HullMesh> before;
      if (isLast) before = mesh_;
      const std::size_t collapsesBefore = collapses_.size();
      strictness_ = strictness;
      pushAll();
      while (mesh_.aliveFaces() > faces && collapseCheapest()) {
      }
      if (!strictness.mayCross) cleanFaces_ = mesh_.aliveFaces();
      if (mesh_.aliveFaces() <= faces) return;
      if (isLast) {
        mesh_ = std::move(*before);
        collapses_.resize(collapsesBefore);
      }
    }
  }

  [[nodiscard]] const HullMesh& mesh() const { return mesh_; }

  [[nodiscard]] const std::vector<HullMesh::Collapse>& collapses() const { return collapses_; }

  [[nodiscard]] std::uint32_t cleanFaces() const { return cleanFaces_; }

 private:
  /// What is known of an edge, kept under the smaller of its two half-edges.
  struct Edge {
    glm::ivec3 position{0};      // where its collapse would put the vertex
    std::uint32_t stamp = 0;     // of its entry in the queue; odd: it has none
    std::uint32_t versions = 0;  // of its ends when it was placed
  };

  struct Entry {
    double volume6 = 0.0;
    HalfEdgeId edge = kNone;
    std::uint32_t stamp = 0;

    /// For a queue whose top is the cheapest; ties by edge, so that the order is the same always.
    bool operator<(const Entry& other) const {
      if (volume6 < other.volume6 || volume6 > other.volume6) return volume6 > other.volume6;
      return edge > other.edge;
    }
  };

  [[nodiscard]] HalfEdgeId edgeOf(HalfEdgeId h) const { return std::min(h, mesh_.links().twin(h)); }

  [[nodiscard]] std::uint32_t versionsOf(HalfEdgeId h) const {
    return versions_[mesh_.links().origin(h)] + versions_[mesh_.links().target(h)];
  }

  void pushAll() {
    for (HalfEdgeId h = 0; h < edges_.size(); ++h) {
      if (mesh_.links().origins[h] != kNone && h == edgeOf(h)) evaluate(h);
    }
  }

  void leaveQueue(HalfEdgeId h) { edges_[h].stamp |= 1; }

  void evaluate(HalfEdgeId h) {
    Edge& edge = edges_[h];
    leaveQueue(mesh_.links().twin(h));
    leaveQueue(h);
    edge.versions = versionsOf(h);
    const auto place = placement_.place(mesh_, h, strictness_.rules);
    if (!place || place->volume6 > strictness_.largestGain * volume6_) return;
    edge.position = place->position;
    queue_.push({place->volume6, h, ++edge.stamp});
  }

  bool collapseCheapest() {
    while (!queue_.empty()) {
      const Entry entry = queue_.top();
      queue_.pop();
      const HalfEdgeId h = entry.edge;
      if (edges_[h].stamp != entry.stamp) continue;
      if (edges_[h].versions != versionsOf(h)) {
        evaluate(h);
        continue;
      }
      leaveQueue(h);
      const glm::ivec3 position = edges_[h].position;
      if (!strictness_.mayCross && guard_.wouldCross(mesh_, h, position)) continue;
      collapse(h, position);
      return true;
    }
    return false;
  }

  void collapse(HalfEdgeId h, const glm::ivec3& position) {
    for (const HalfEdgeId dying : {h, mesh_.links().twin(h)}) {
      for (std::uint32_t k = 0; k < 3; ++k)
        leaveQueue(3 * HalfEdgeMesh::face(dying) + k);
    }
    collapses_.push_back(mesh_.collapse(h, position));
    const HalfEdgeMesh& links = mesh_.links();
    const std::uint32_t kept = collapses_.back().kept;
    if (!strictness_.mayCross) guard_.collapsed(mesh_, kept);

    ++versions_[kept];
    const HalfEdgeId first = links.outgoing[kept];
    HalfEdgeId i = first;
    do {
      ++versions_[links.target(i)];
      i = links.rotateCcw(i);
    } while (i != first);
    // Edges of the vertex are placed anew at once. Those of its neighbours have their place checked
    // when their turn comes, which is soon enough since volumes mostly rise; but those that had no
    // place have no turn, and may have one now.
    do {
      evaluate(edgeOf(i));
      const HalfEdgeId back = links.twin(i);
      for (HalfEdgeId j = links.rotateCcw(back); j != back; j = links.rotateCcw(j)) {
        const HalfEdgeId e = edgeOf(j);
        if (edges_[e].stamp % 2 == 1 && edges_[e].versions != versionsOf(e)) evaluate(e);
      }
      i = links.rotateCcw(i);
    } while (i != first);
  }

  HullMesh mesh_;
  const double volume6_;  // of the mesh at first
  CrossingGuard guard_;
  HullPlacement placement_;
  Strictness strictness_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> versions_;  // of vertices: grow when a face of theirs changes
  std::priority_queue<Entry> queue_;
  std::vector<HullMesh::Collapse> collapses_;
  std::uint32_t cleanFaces_ = 0;
};

/// Base vertices first, then in reverse order of removal.
ProgressiveHull
record(const HullMesh& mesh, const std::vector<HullMesh::Collapse>& collapses, std::size_t splits) {
  ProgressiveHull hull;
  std::vector<std::uint32_t> number(mesh.positions().size(), kNone);
  std::uint32_t next = 0;
  for (FaceId f = 0; f < mesh.links().faceCount(); ++f) {
    if (!mesh.isAlive(f)) continue;
    glm::uvec3 triangle;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.links().origins[3 * f + k];
      if (number[v] == kNone) {
        number[v] = next++;
        hull.base.positions.push_back(mesh.positions()[v]);
      }
      triangle[static_cast<int>(k)] = number[v];
    }
    hull.base.triangles.push_back(triangle);
  }
  for (std::size_t i = collapses.size(); i-- > collapses.size() - splits;) {
    const HullMesh::Collapse& c = collapses[i];
    number[c.removed] = next++;
    hull.splits.push_back(
        {number[c.kept], number[c.left], number[c.right], c.keptPosition, c.removedPosition});
  }
  return hull;
}

/// The same surface, seen from its other side.
void turnOver(ProgressiveHull& hull) {
  for (glm::uvec3& t : hull.base.triangles)
    std::swap(t.y, t.z);
  for (HullSplit& split : hull.splits)
    std::swap(split.left, split.right);
}

}  // namespace

Result<BuiltHull> buildHull(const TriangleMesh& mesh, HullSide side, const HullOptions& options) {
  std::vector<glm::uvec3> triangles = mesh.triangles;
  if (side == HullSide::kInner) {
    for (glm::uvec3& t : triangles)
      std::swap(t.y, t.z);
  }
  auto links = HalfEdgeMesh::build(static_cast<std::uint32_t>(mesh.positions.size()), triangles);
  if (!links) return tl::unexpected(links.error());
  if (std::find(links->twins.begin(), links->twins.end(), kNone) != links->twins.end()) {
    return fail(ErrorCode::kNonManifold, "a hull needs a closed mesh");
  }
  std::vector<glm::ivec3> positions = mesh.positions;
  for (glm::ivec3& p : positions) {
    p *= 1 << options.extraBits;
    if (glm::any(glm::greaterThan(glm::abs(p), glm::ivec3(kMaxHullCoordinate)))) {
      return fail(ErrorCode::kLimitExceeded, "the grid is too fine for a hull");
    }
  }
  const double volume = std::abs(volume6(mesh)) * std::ldexp(1.0, 3 * options.extraBits);
  HullBuilder builder(HullMesh(std::move(*links), std::move(positions)), volume);
  builder.run(options.baseFaces);

  BuiltHull result;
  const std::uint32_t baseFaces = builder.mesh().aliveFaces();
  const std::size_t most =
      options.finestFaces > baseFaces ? (options.finestFaces - baseFaces) / 2 : 0;
  result.hull =
      record(builder.mesh(), builder.collapses(), std::min(most, builder.collapses().size()));
  if (side == HullSide::kInner) turnOver(result.hull);
  result.hull.base.grid = mesh.grid;
  result.hull.base.grid.step = std::ldexp(mesh.grid.step, -options.extraBits);
  result.hull.base.grid.bits = mesh.grid.bits + options.extraBits;
  result.cleanFaces = builder.cleanFaces();
  return result;
}

}  // namespace limn
