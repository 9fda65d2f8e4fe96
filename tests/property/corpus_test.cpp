// SPDX-License-Identifier: Apache-2.0
#include "tests/corpus/corpus.h"

#include "shared/mesh/half_edge.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

TEST(Corpus, EveryMeshIsAnOrientedManifold) {
  for (const corpus::Mesh* mesh : corpus::allGood()) {
    const auto linked = HalfEdgeMesh::build(
        static_cast<std::uint32_t>(mesh->mesh.positions.size()),
        mesh->mesh.triangles);
    ASSERT_TRUE(linked) << mesh->name << ": " << linked.error().message;
    const auto valid = validate(*linked);
    EXPECT_TRUE(valid) << mesh->name;
    const bool border =
        std::find(linked->twins.begin(), linked->twins.end(), kNone) != linked->twins.end();
    EXPECT_EQ(mesh->closed, !border) << mesh->name;
  }
}

TEST(Corpus, NoSmallRealModelIsRefused) {
  if (!corpus::modelsFolder()) {
    GTEST_SKIP() << corpus::kNoModels;
  }
  EXPECT_GT(corpus::allGood().size(), corpus::generated().size());
  const auto failures = corpus::failures();
  EXPECT_TRUE(failures.empty()) << failures.front();
}

TEST(Corpus, ClosedAndOpenMeshesTogetherAreAll) {
  const auto closed = corpus::closedMeshes();
  const auto open = corpus::openMeshes();
  EXPECT_FALSE(closed.empty());
  EXPECT_FALSE(open.empty());
  EXPECT_EQ(closed.size() + open.size(), corpus::allGood().size());
}

}  // namespace
}  // namespace limn
