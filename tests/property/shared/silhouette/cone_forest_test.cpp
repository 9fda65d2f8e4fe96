// SPDX-License-Identifier: Apache-2.0
// Cones that follow a mesh through splits and undone splits find what brute force finds.
#include "shared/silhouette/cone_forest.h"

#include "server/preprocess/forest/build_forest.h"
#include "tests/corpus/corpus.h"
#include "tests/property/shared/silhouette/wanderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

namespace limn {
namespace {

constexpr SilhouetteKind kKinds[] = {SilhouetteKind::kEdges, SilhouetteKind::kSmooth};

std::size_t itemsOf(const ConeForest& cones) {
  std::size_t items = 0;
  for (const auto& tree : cones.trees())
    items += tree.items;
  return items;
}

TEST(ConeForest, RefittedEqualsBruteForceAfterRandomRefinementsAndUndos) {
  for (const corpus::Mesh* subject : corpus::allGood(corpus::Size::kSmall)) {
    if (subject->mesh.triangles.size() > 9000) continue;
    SCOPED_TRACE(subject->name);
    for (const SilhouetteKind kind : kKinds) {
      // Splits that move their parents change faces that they do not touch.
      const Placement placement =
          kind == SilhouetteKind::kEdges ? Placement::kVolume : Placement::kSubset;
      const auto built =
          buildForest(subject->mesh, {.baseFaces = 100, .placement = placement, .threads = 1});
      ASSERT_TRUE(built);
      testing::Wanderer wanderer(built->forest, 11);
      std::optional<SilhouetteField> field;
      field.emplace(wanderer.mesh().mesh(), wanderer.mesh().positions(), kind);
      ConeForest cones(*field);
      for (int step = 0; step < 12; ++step) {
        const ActiveMesh before = wanderer.mesh();
        ASSERT_NO_FATAL_FAILURE(wanderer.step(std::max(wanderer.splits() / 6, 1U)));
        field.emplace(wanderer.mesh().mesh(), wanderer.mesh().positions(), kind);
        cones.refit(before.mesh(), before.positions(), *field);
        ASSERT_EQ(itemsOf(cones), itemsOf(ConeForest(*field)));
        EXPECT_GE(cones.looseness(), 0.5);
        ASSERT_NO_FATAL_FAILURE(testing::expectComplete(
            *field,
            std::make_shared<const ConeForest>(cones),
            wanderer.shape(),
            8));
      }
    }
  }
}

TEST(ConeForest, AMeshThatDidNotChangeKeepsItsCones) {
  const corpus::Mesh& subject = corpus::generated().front();
  const auto mesh = HalfEdgeMesh::build(
      static_cast<std::uint32_t>(subject.mesh.positions.size()),
      subject.mesh.triangles);
  ASSERT_TRUE(mesh);
  for (const SilhouetteKind kind : kKinds) {
    const SilhouetteField field(*mesh, subject.mesh.positions, kind);
    ConeForest cones(field);
    EXPECT_EQ(cones.looseness(), 1.0);
    cones.refit(*mesh, subject.mesh.positions, field);
    EXPECT_EQ(cones.trees().size(), 1U);
    EXPECT_EQ(cones.looseness(), 1.0);
  }
}

}  // namespace
}  // namespace limn
