// SPDX-License-Identifier: Apache-2.0
#include "server/session/dependents.h"

#include "server/session/target_set.h"
#include "tests/unit/server/session/test_model.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

namespace limn {
namespace {

TEST(Dependents, KeepNoMoreThanWhatIsLeftNeeds) {
  const BuiltForest built = builtForestOf(primitives::bumpySphere(3, 3), 60);
  const SplitForest& forest = built.forest;
  const Dependents dependents(forest);
  Rng rng(4);
  for (int round = 0; round < 20; ++round) {
    // A closed have-set: everything up to some id. And any part of it.
    HaveSet have(forest.vertexCount());
    const std::uint32_t base = forest.baseVertexCount();
    const VertexId end = base + 1 + rng.below(forest.splitCount());
    have.addRange(0, end);
    std::vector<VertexId> ids;
    const std::uint32_t every = 1 + rng.below(4);
    for (VertexId v = base; v < end; ++v) {
      if (v >= end / 2 && rng.below(every) == 0) ids.push_back(v);
    }
    const auto kept = dependents.neededOf(have, ids);
    HaveSet left = have;
    for (const VertexId v : ids)
      left.remove(v);
    // The slow way: put back what is needed until nothing is missing.
    for (bool changed = true; changed;) {
      changed = false;
      for (VertexId v = base; v < end; ++v) {
        if (!left.holds(v)) continue;
        const auto need = [&](VertexId w) {
          if (!left.holds(w)) changed = true;
          left.add(w);
        };
        forest.forEachPrerequisite(v, need);
      }
    }
    std::vector<VertexId> expected;
    for (const VertexId v : ids) {
      if (left.holds(v)) expected.push_back(v);
    }
    EXPECT_EQ(kept, expected);
    EXPECT_TRUE(isClosed(forest, left.words()));
  }
}

}  // namespace
}  // namespace limn
