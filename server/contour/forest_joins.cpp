// SPDX-License-Identifier: Apache-2.0
//
// Based on: P. V. Sander, X. Gu, S. J. Gortler, H. Hoppe, J. Snyder, "Silhouette Clipping",
// SIGGRAPH 2000, section 5 (tree construction). With P a node's share of eyes that its cones do
// not hold, the paper's recursive costs add up to
//   rootCost(r) = node + S(r),  S(n) = P(n) (edges of n + node · children of n) + Σ S(children),
// so a join changes the forest's cost by what it changes in P and in those counts of two roots.
// Deviations: candidates are mesh neighbours by faces, not vertices (half as many); cones are
// predicted from samples (plane_sample.h) and fitted to all faces once the forest stands.
#include "server/contour/forest_joins.h"

#include "server/contour/plane_sample.h"

#include <algorithm>
#include <array>
#include <queue>
#include <tuple>
#include <utility>

namespace limn {
namespace {

enum class Join : std::uint8_t { kParent, kAdoptSecond, kAdoptFirst, kMerge };

/// A list within arrays of next items.
struct Chain {
  std::uint32_t first = kNone;
  std::uint32_t last = kNone;
  std::uint32_t count = 0;

  void append(const Chain& other, std::vector<std::uint32_t>& next) {
    if (other.count == 0) return;
    if (count == 0) {
      first = other.first;
    } else {
      next[last] = other.first;
    }
    last = other.last;
    count += other.count;
  }
};

struct BuildNode {
  Chain edges;
  Chain children;
};

/// A root, a vertex of the candidate graph.
struct Root {
  std::uint32_t node = kNone;
  std::uint32_t version = 0;
  std::uint32_t faces = 2;  // about as many as its sample stands for
  double missed = 1.0;
  PlaneSample sample;
  std::vector<std::uint32_t> neighbours;  // ascending
};

struct Candidate {
  float cost = 0.0F;  // what joining changes
  std::uint32_t faces = 0;
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  std::uint32_t versionA = 0;
  std::uint32_t versionB = 0;
  Join join = Join::kParent;

  /// The best last; of equal ones small clusters, so that flat regions grow evenly.
  friend bool operator<(const Candidate& x, const Candidate& y) {
    return std::tie(y.cost, y.faces, y.a, y.b) < std::tie(x.cost, x.faces, x.a, x.b);
  }
};

class Joiner {
 public:
  Joiner(const SilhouetteField& field, const ForestCost& cost) : field_(field), cost_(cost) {
    placeEdges();
    double radius2 = 1.0;
    for (const glm::ivec3& p : field.positions()) {
      const glm::dvec3 from(p - field.center());
      radius2 = std::max(radius2, glm::dot(from, from));
    }
    eyeRadius_ = cost.eyeRadii * std::sqrt(radius2);
  }

  ForestShape build() {
    for (std::uint32_t a = 0; a < roots_.size(); ++a) {
      for (const std::uint32_t b : roots_[a].neighbours) {
        if (a < b) propose(a, b);
      }
    }
    while (!candidates_.empty()) {
      const Candidate best = candidates_.top();
      candidates_.pop();
      if (roots_[best.a].version != best.versionA || roots_[best.b].version != best.versionB)
        continue;
      if (best.cost >= 0.0F) break;
      apply(best);
    }
    return shape();
  }

 private:
  static constexpr std::uint32_t kGone = 0xFFFFFFFF;

  void placeEdges() {
    const HalfEdgeMesh& mesh = field_.mesh();
    std::vector<std::uint32_t> edgeOf(mesh.origins.size(), kNone);
    for (HalfEdgeId h = 0; h < mesh.origins.size(); ++h) {
      if (mesh.twin(h) == kNone || mesh.twin(h) < h) continue;
      edgeOf[h] = edgeOf[mesh.twin(h)] = static_cast<std::uint32_t>(edges_.size());
      edges_.push_back(h);
    }
    const auto count = static_cast<std::uint32_t>(edges_.size());
    nextEdge_.assign(count, kNone);
    nextNode_.assign(count, kNone);
    nodes_.resize(count);
    roots_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      nodes_[i].edges = {i, i, 1};
      Root& root = roots_[i];
      root.node = i;
      const HalfEdgeId h = edges_[i];
      const std::array faces = {HalfEdgeMesh::face(h), HalfEdgeMesh::face(mesh.twin(h))};
      for (const FaceId f : faces) {
        const glm::vec4 plane = field_.plane(f);
        const float length = glm::length(glm::vec3(plane));
        if (length > 0.0F) {
          root.sample.planes[root.sample.count++] = plane / length;
        } else {
          root.sample.hasDegenerate = true;
        }
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t other = edgeOf[3 * f + k];
          if (other != kNone && other != i) root.neighbours.push_back(other);
        }
      }
      std::sort(root.neighbours.begin(), root.neighbours.end());
      root.neighbours.erase(
          std::unique(root.neighbours.begin(), root.neighbours.end()),
          root.neighbours.end());
      const glm::ivec3 both =
          field_.positions()[mesh.origin(h)] + field_.positions()[mesh.target(h)];
      root.sample.center = 0.5F * glm::vec3(both) - glm::vec3(field_.center());
    }
    for (Root& root : roots_)
      root.missed = missedByJoin(root.sample, {}, {1.0F, 0.0F}, eyeRadius_);
  }

  [[nodiscard]] static glm::vec2 weights(const Root& a, const Root& b) {
    return {static_cast<float>(a.faces), static_cast<float>(b.faces)};
  }

  /// What eyes within a node cost there, in tests of edges.
  [[nodiscard]] double inside(const BuildNode& node) const {
    return node.edges.count + cost_.node * node.children.count;
  }

  void propose(std::uint32_t a, std::uint32_t b) {
    const Root& x = roots_[a];
    const Root& y = roots_[b];
    const double missed = missedByJoin(x.sample, y.sample, weights(x, y), eyeRadius_);
    const double insideA = inside(nodes_[x.node]);
    const double insideB = inside(nodes_[y.node]);
    const std::array<double, 4> costs = {
        missed * 2.0 * cost_.node,
        missed * (insideA + cost_.node) - x.missed * insideA,
        missed * (insideB + cost_.node) - y.missed * insideB,
        missed * (insideA + insideB) - x.missed * insideA - y.missed * insideB,
    };
    const auto best = std::min_element(costs.begin(), costs.end());
    const double change = *best - cost_.node;
    if (change >= 0.0) return;
    candidates_.push(
        {static_cast<float>(change),
         x.faces + y.faces,
         a,
         b,
         x.version,
         y.version,
         static_cast<Join>(best - costs.begin())});
  }

  std::uint32_t joined(std::uint32_t a, std::uint32_t b, Join join) {
    const Chain childA{a, a, 1};
    const Chain childB{b, b, 1};
    switch (join) {
      case Join::kParent: {
        BuildNode parent;
        parent.children.append(childA, nextNode_);
        parent.children.append(childB, nextNode_);
        nodes_.push_back(parent);
        nextNode_.push_back(kNone);
        return static_cast<std::uint32_t>(nodes_.size() - 1);
      }
      case Join::kAdoptSecond:
        nodes_[a].children.append(childB, nextNode_);
        return a;
      case Join::kAdoptFirst:
        nodes_[b].children.append(childA, nextNode_);
        return b;
      case Join::kMerge:
        nodes_[a].edges.append(nodes_[b].edges, nextEdge_);
        nodes_[a].children.append(nodes_[b].children, nextNode_);
        nodes_[b] = {};
        return a;
    }
    return a;
  }

  void apply(const Candidate& best) {
    Root& a = roots_[best.a];
    Root& b = roots_[best.b];
    JoinedSample sample = join(a.sample, b.sample, weights(a, b), eyeRadius_);
    a.node = joined(a.node, b.node, best.join);
    a.sample = sample.sample;
    a.missed = sample.missed;
    a.faces += b.faces;
    ++a.version;
    b.version = kGone;
    std::vector<std::uint32_t> around;
    std::set_union(
        a.neighbours.begin(),
        a.neighbours.end(),
        b.neighbours.begin(),
        b.neighbours.end(),
        std::back_inserter(around));
    std::erase_if(around, [&](std::uint32_t x) { return x == best.a || x == best.b; });
    for (const std::uint32_t x : b.neighbours) {
      if (x == best.a) continue;
      auto& list = roots_[x].neighbours;
      list.erase(std::lower_bound(list.begin(), list.end(), best.b));
      const auto at = std::lower_bound(list.begin(), list.end(), best.a);
      if (at == list.end() || *at != best.a) list.insert(at, best.a);
    }
    b.neighbours = {};
    a.neighbours = std::move(around);
    for (const std::uint32_t x : a.neighbours)
      propose(std::min(x, best.a), std::max(x, best.a));
  }

  /// Depth first without recursion: a node's end is known when the stack is back at it.
  void emit(std::uint32_t root, ForestShape& shape) const {
    struct Open {
      std::uint32_t emitted;
      std::uint32_t nextChild;
      std::uint32_t childrenLeft;
    };

    std::vector<Open> open;
    const auto enter = [&](const BuildNode& node) {
      ForestShape::Node made;
      made.edgeBegin = static_cast<std::uint32_t>(shape.edges.size());
      std::uint32_t e = node.edges.first;
      for (std::uint32_t left = node.edges.count; left > 0; --left) {
        shape.edges.push_back(edges_[e]);
        e = nextEdge_[e];
      }
      made.edgeEnd = static_cast<std::uint32_t>(shape.edges.size());
      open.push_back(
          {static_cast<std::uint32_t>(shape.nodes.size()),
           node.children.first,
           node.children.count});
      shape.nodes.push_back(made);
    };
    enter(nodes_[root]);
    while (!open.empty()) {
      Open& top = open.back();
      if (top.childrenLeft == 0) {
        shape.nodes[top.emitted].past = static_cast<std::uint32_t>(shape.nodes.size());
        open.pop_back();
        continue;
      }
      --top.childrenLeft;
      const std::uint32_t child = top.nextChild;
      top.nextChild = nextNode_[child];
      enter(nodes_[child]);
    }
  }

  [[nodiscard]] ForestShape shape() const {
    ForestShape result;
    result.edges.reserve(edges_.size());
    for (const Root& root : roots_) {
      if (root.version != kGone) emit(root.node, result);
    }
    return result;
  }

  const SilhouetteField& field_;
  ForestCost cost_;
  double eyeRadius_ = 1.0;
  std::vector<HalfEdgeId> edges_;
  std::vector<std::uint32_t> nextEdge_;  // by edge
  std::vector<std::uint32_t> nextNode_;  // by node, among its parent's children
  std::vector<BuildNode> nodes_;
  std::vector<Root> roots_;
  std::priority_queue<Candidate> candidates_;
};

}  // namespace

ForestShape joinEdges(const SilhouetteField& field, const ForestCost& cost) {
  return Joiner(field, cost).build();
}

}  // namespace limn
