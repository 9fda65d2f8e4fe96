// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/split_codec.h"

#include "server/preprocess/build_forest.h"
#include "tests/property/legal_order.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

SplitForest forestOf(const TriangleMesh& mesh) {
  ForestOptions options;
  options.baseFaces = 80;
  auto built = buildForest(mesh, options);
  EXPECT_TRUE(built);
  return std::move(built->forest);
}

ActiveMesh baseOf(const SplitForest& forest) {
  TriangleMesh base{forest.grid, {}, forest.baseTriangles};
  base.positions.assign(
      forest.positions.begin(),
      forest.positions.begin() + forest.baseVertexCount());
  return *ActiveMesh::fromBase(forest.levelBegin, base, forest.baseFeatures);
}

// Positions and features of every held vertex equal the forest's.
void expectEqualSoFar(const SplitForest& forest, const ActiveMesh& active) {
  EXPECT_TRUE(validate(active.mesh()));
  for (Slot s = 0; s < active.ids().size(); ++s) {
    ASSERT_EQ(active.positions()[s], forest.positions[active.ids()[s]]);
  }
}

std::vector<TriangleMesh> shapes() {
  return {
      primitives::icosphere(4),
      primitives::torusKnot(2, 3, 240, 12),
      primitives::openGrid(40, 30),
      primitives::cube(),
      primitives::bumpySphere(4, 3)};
}

TEST(SplitCodec, LevelsInOrderGiveTheFullMesh) {
  for (const TriangleMesh& shape : shapes()) {
    const SplitForest forest = forestOf(shape);
    const SplitModel model = trainSplitModel(forest);
    ActiveMesh active = baseOf(forest);
    for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
      std::vector<VertexId> ids;
      for (VertexId v = forest.levelBegin[level]; v < forest.levelBegin[level + 1]; ++v)
        ids.push_back(v);
      const auto bytes = encodeSplits(forest, model, ids);
      const auto count = decodeSplits(bytes, model, active);
      ASSERT_TRUE(count) << count.error().message;
      EXPECT_EQ(*count, ids.size());
    }
    EXPECT_EQ(active.splitsHeld(), forest.splitCount());
    expectEqualSoFar(forest, active);
  }
}

TEST(SplitCodec, PacketsOfAnyLegalOrderDecode) {
  Rng rng(17);
  for (const TriangleMesh& shape : shapes()) {
    const SplitForest forest = forestOf(shape);
    const SplitModel model = trainSplitModel(forest);
    ActiveMesh active = baseOf(forest);
    const auto order = randomLegalOrder(forest, rng, OrderKind::kDepthFirst);
    for (std::size_t begin = 0; begin < order.size();) {
      const std::size_t end = std::min(order.size(), begin + 1 + rng.below(60));
      std::vector<VertexId> ids(
          order.begin() + static_cast<std::ptrdiff_t>(begin),
          order.begin() + static_cast<std::ptrdiff_t>(end));
      std::sort(ids.begin(), ids.end());
      ASSERT_TRUE(decodeSplits(encodeSplits(forest, model, ids), model, active));
      begin = end;
    }
    EXPECT_EQ(active.splitsHeld(), forest.splitCount());
    expectEqualSoFar(forest, active);
  }
}

TEST(SplitCodec, ModelsSurviveSerialisationAndNoTruncationPasses) {
  const SplitModel model = trainSplitModel(forestOf(primitives::icosphere(4)));
  const auto bytes = serializeSplitModel(model);
  const auto back = parseSplitModel(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->probabilities, model.probabilities);
  EXPECT_EQ(back->weights, model.weights);
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    EXPECT_FALSE(parseSplitModel(std::span(bytes).first(cut))) << cut;
  }
}

// Whatever the bytes: an error or a valid mesh, never anything else.
TEST(SplitCodec, DamagedRunsLeaveAValidMesh) {
  const SplitForest forest = forestOf(primitives::torusKnot(2, 3, 120, 10));
  const SplitModel model = trainSplitModel(forest);
  std::vector<VertexId> ids(forest.splitCount());
  for (std::uint32_t s = 0; s < ids.size(); ++s)
    ids[s] = forest.baseVertexCount() + s;
  const auto bytes = encodeSplits(forest, model, ids);
  Rng rng(23);
  for (int run = 0; run < 400; ++run) {
    auto damaged = bytes;
    if (run % 2 == 0) {
      damaged.resize(rng.below(static_cast<std::uint32_t>(damaged.size())));
    }
    for (int i = 0; i < 3 && !damaged.empty(); ++i) {
      damaged[rng.below(static_cast<std::uint32_t>(damaged.size()))] ^=
          static_cast<std::uint8_t>(1U << rng.below(8));
    }
    ActiveMesh active = baseOf(forest);
    const auto count = decodeSplits(damaged, model, active);
    EXPECT_LE(count.value_or(0), forest.splitCount());
    if (run % 8 == 0) {
      const auto valid = validate(active.mesh());
      EXPECT_TRUE(valid) << valid.error().message;
    }
  }
}

TEST(SplitCodec, EveryTruncationIsAnError) {
  const SplitForest forest = forestOf(primitives::icosphere(3));
  const SplitModel model = trainSplitModel(forest);
  std::vector<VertexId> ids(forest.splitCount());
  for (std::uint32_t s = 0; s < ids.size(); ++s)
    ids[s] = forest.baseVertexCount() + s;
  const auto bytes = encodeSplits(forest, model, ids);
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    ActiveMesh active = baseOf(forest);
    EXPECT_FALSE(decodeSplits(std::span(bytes).first(cut), model, active)) << cut;
  }
}

}  // namespace
}  // namespace limn
