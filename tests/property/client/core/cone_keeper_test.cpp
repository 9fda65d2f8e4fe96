// SPDX-License-Identifier: Apache-2.0
#include "client/core/cone_keeper.h"

#include "server/preprocess/forest/build_forest.h"
#include "tests/property/shared/silhouette/wanderer.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(ConeKeeper, FollowsSnapshotsAndRebuildsLooseConesInTheBackground) {
  const TriangleMesh shape = primitives::torusKnot(2, 3, 200, 16);
  const auto built = buildForest(shape, {.baseFaces = 100, .threads = 1});
  ASSERT_TRUE(built);
  for (const SilhouetteKind kind : {SilhouetteKind::kEdges, SilhouetteKind::kSmooth}) {
    testing::Wanderer wanderer(built->forest, 4);
    ConeKeeper keeper(kind, {.rebuildAbove = 1.02});
    for (int step = 0; step < 40; ++step) {
      ASSERT_NO_FATAL_FAILURE(wanderer.step(std::max(wanderer.splits() / 12, 1U)));
      auto snapshot = std::make_shared<MeshSnapshot>();
      snapshot->mesh = wanderer.mesh();
      const SilhouetteField field(snapshot->mesh.mesh(), snapshot->mesh.positions(), kind);
      const auto cones = keeper.conesOf(snapshot, field);
      ASSERT_NO_FATAL_FAILURE(testing::expectComplete(field, cones, wanderer.shape(), 2));
      keeper.wait();  // so that the next one finds it
    }
    EXPECT_GT(keeper.replacements(), 0U);
    // Another model's cones are its own.
    auto other = std::make_shared<MeshSnapshot>();
    other->model.asset[0] = std::uint8_t{1};
    other->mesh = testing::Wanderer(built->forest, 9).mesh();
    const SilhouetteField field(other->mesh.mesh(), other->mesh.positions(), kind);
    EXPECT_EQ(keeper.conesOf(other, field)->looseness(), 1.0);
  }
}

}  // namespace
}  // namespace limn
