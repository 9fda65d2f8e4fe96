// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/build_forest.h"
#include "tests/property/canonical_mesh.h"
#include "tests/property/forest_shapes.h"
#include "tests/property/legal_order.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <tuple>

namespace limn {
namespace {

/// Which splits may be applied or undone now: the slow way, from the forest's stored rings.
class Legality {
 public:
  explicit Legality(const SplitForest& forest)
      : forest_(forest),
        dependents_(forest.vertexCount()),
        missing_(forest.vertexCount(), 0),
        built_(forest.vertexCount(), 0),
        held_(forest.vertexCount(), false) {
    for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v) {
      forest.forEachPrerequisite(v, [&](VertexId w) {
        dependents_[w].push_back(v);
        if (w >= forest.baseVertexCount()) ++missing_[v];
      });
    }
  }

  [[nodiscard]] bool mayApply(VertexId v) const { return !held_[v] && missing_[v] == 0; }

  [[nodiscard]] bool mayUndo(VertexId v) const { return held_[v] && built_[v] == 0; }

  [[nodiscard]] bool holds(VertexId v) const { return held_[v]; }

  void set(VertexId v, bool held) {
    held_[v] = held;
    for (const VertexId w : dependents_[v])
      missing_[w] += held ? -1 : 1;
    forest_.forEachPrerequisite(v, [&](VertexId w) { built_[w] += held ? 1 : -1; });
  }

 private:
  const SplitForest& forest_;
  std::vector<std::vector<VertexId>> dependents_;
  std::vector<int> missing_;  // prerequisites that are not held
  std::vector<int> built_;    // held splits that need this one
  std::vector<bool> held_;
};

bool sameSplit(const VertexSplit& a, const VertexSplit& b) {
  return a.vertex == b.vertex && a.parent == b.parent && a.left == b.left && a.right == b.right &&
         a.position == b.position && a.parentMove == b.parentMove && a.features == b.features &&
         a.seams == b.seams && a.attributes == b.attributes;
}

class Undo : public testing::TestWithParam<ForestCase> {
 protected:
  void SetUp() override {
    ForestOptions options;
    options.baseFaces = 40;
    options.placement = std::get<1>(GetParam());
    auto built = buildForest(forestShapes()[std::get<0>(GetParam())].mesh, options);
    ASSERT_TRUE(built) << built.error().message;
    built_ = std::move(*built);
  }

  /// The mesh of the same splits, never undone: applied in order of id.
  [[nodiscard]] CanonicalMesh afresh(const Legality& state) const {
    ActiveMesh active = baseMeshOf(forest());
    for (VertexId v = forest().baseVertexCount(); v < forest().vertexCount(); ++v) {
      if (!state.holds(v)) continue;
      EXPECT_TRUE(active.apply(forest().split(v)));
    }
    return canonicalOf(active);
  }

  [[nodiscard]] const SplitForest& forest() const { return built_.forest; }

  BuiltForest built_;
};

// Several thousand steps up and down in random legal order; whatever the history, the mesh is that
// of the splits held.
TEST_P(Undo, AnyLegalHistoryLeavesTheMeshOfWhatIsHeld) {
  const std::uint32_t base = forest().baseVertexCount();
  const std::uint32_t splits = forest().splitCount();
  if (splits == 0) return;
  Rng rng(std::get<0>(GetParam()) + 40);
  Legality state(forest());
  ActiveMesh active = baseMeshOf(forest());
  std::uint32_t undone = 0;
  std::uint32_t applied = 0;
  bool growing = true;
  for (int step = 0; undone < 4000 && step < 400'000; ++step) {
    const VertexId v = base + rng.below(splits);
    // Up to most of the mesh, then down to a little of it, and again.
    if (active.splitsHeld() * 10 > splits * 9) growing = false;
    if (active.splitsHeld() * 10 < splits) growing = true;
    const bool up = rng.below(10) < (growing ? 8U : 2U);
    if (up && state.mayApply(v)) {
      ASSERT_TRUE(active.apply(forest().split(v)));
      state.set(v, true);
      ++applied;
    } else if (!up && state.mayUndo(v)) {
      const auto split = active.undo(v);
      ASSERT_TRUE(split) << split.error().message;
      ASSERT_TRUE(sameSplit(*split, forest().split(v))) << "split " << v;
      state.set(v, false);
      ++undone;
    } else {
      continue;
    }
    if ((undone + applied) % 1500 == 0) {
      const auto valid = validate(active.mesh());
      ASSERT_TRUE(valid) << valid.error().message;
      ASSERT_EQ(canonicalOf(active), afresh(state));
    }
  }
  EXPECT_GE(undone, 4000U);
  EXPECT_EQ(canonicalOf(active), afresh(state));
}

TEST_P(Undo, EverythingUndoneIsTheBaseMeshAndEverythingRedoneTheWholeOne) {
  Rng rng(std::get<0>(GetParam()));
  const CanonicalMesh baseMesh = canonicalOf(baseMeshOf(forest()));
  ActiveMesh active = baseMeshOf(forest());
  const auto order = randomLegalOrder(forest(), rng, OrderKind::kDepthFirst);
  for (const VertexId v : order)
    ASSERT_TRUE(active.apply(forest().split(v)));
  const CanonicalMesh whole = canonicalOf(active);
  // A legal order backwards is a legal order of undoing; here one that is not the one of applying.
  auto back = randomLegalOrder(forest(), rng, OrderKind::kUniform);
  std::vector<VertexSplit> splits;
  for (auto v = back.rbegin(); v != back.rend(); ++v) {
    auto split = active.undo(*v);
    ASSERT_TRUE(split) << split.error().message;
    splits.push_back(*split);
  }
  EXPECT_EQ(active.splitsHeld(), 0U);
  EXPECT_EQ(canonicalOf(active), baseMesh);
  for (auto split = splits.rbegin(); split != splits.rend(); ++split)
    ASSERT_TRUE(active.apply(*split));
  EXPECT_EQ(canonicalOf(active), whole);
}

// Whatever is undone, legally or not, the mesh stays a manifold, and a refusal changes nothing.
TEST_P(Undo, WhatIsNotLegalLeavesAManifold) {
  Rng rng(std::get<0>(GetParam()) + 7);
  ActiveMesh active = baseMeshOf(forest());
  for (VertexId v = forest().baseVertexCount(); v < forest().vertexCount(); ++v)
    ASSERT_TRUE(active.apply(forest().split(v)));
  EXPECT_FALSE(active.undo(0));
  EXPECT_FALSE(active.undo(forest().vertexCount()));
  EXPECT_FALSE(active.undo(kNone));
  std::uint32_t refused = 0;
  for (int step = 0; step < 600; ++step) {
    const VertexId v = rng.below(forest().vertexCount());
    const std::uint32_t before = active.splitsHeld();
    if (active.undo(v)) {
      EXPECT_EQ(active.splitsHeld() + 1, before);
    } else {
      EXPECT_EQ(active.splitsHeld(), before);
      ++refused;
    }
    if (step % 100 == 0) {
      const auto valid = validate(active.mesh());
      ASSERT_TRUE(valid) << valid.error().message;
    }
  }
  EXPECT_TRUE(validate(active.mesh()));
  EXPECT_GT(refused, 0U);
}

// A forest without splits has nothing to undo.
INSTANTIATE_TEST_SUITE_P(Shapes, Undo, forestCases(1), nameOfForestCase);

// A server that announces the largest model there may be, and sends a tetrahedron.
TEST(ActiveMeshMemory, FollowsWhatIsHeldNotWhatIsAnnounced) {
  const TriangleMesh tetrahedron = primitives::tetrahedron();
  auto active = ActiveMesh::fromBase({0, 4, 1U << 27}, tetrahedron, {});
  ASSERT_TRUE(active) << active.error().message;
  EXPECT_LT(active->bytes(), 64U * 1024U);
  EXPECT_FALSE(active->holds((1U << 27) - 1));
}

}  // namespace
}  // namespace limn
