// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/split_codec.h"

#include "server/preprocess/forest/build_forest.h"
#include "tests/property/legal_order.h"

#include "shared/codec/packet_encoder.h"
#include "shared/codec/split_training.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace limn {
namespace {

constexpr std::array<Placement, 2> kPlacements = {Placement::kSubset, Placement::kVolume};

SplitForest forestOf(const TriangleMesh& mesh, Placement placement = Placement::kSubset) {
  ForestOptions options;
  options.baseFaces = 80;
  options.placement = placement;
  auto built = buildForest(mesh, options);
  EXPECT_TRUE(built);
  return std::move(built->forest);
}

ActiveMesh baseOf(const SplitForest& forest) {
  return *ActiveMesh::fromBase(forest.levelBegin, forest.baseMesh(), forest.baseFeatures);
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

// Every shape, with parents that stay and with parents that move.
std::vector<SplitForest> forests() {
  std::vector<SplitForest> all;
  for (const TriangleMesh& shape : shapes()) {
    for (const Placement placement : kPlacements)
      all.push_back(forestOf(shape, placement));
  }
  return all;
}

SplitModel modelOf(const SplitForest& forest) {
  return trainSplitModel(forest, frontsOf(forest));
}

std::vector<VertexId> allSplits(const SplitForest& forest) {
  std::vector<VertexId> ids(forest.splitCount());
  for (std::uint32_t s = 0; s < ids.size(); ++s)
    ids[s] = forest.baseVertexCount() + s;
  return ids;
}

TEST(SplitCodec, LevelRunsInOrderGiveTheFullMesh) {
  for (const SplitForest& forest : forests()) {
    const LevelFronts fronts = frontsOf(forest);
    const SplitModel model = trainSplitModel(forest, fronts);
    ActiveMesh active = baseOf(forest);
    SplitDecoder decoder(model);
    for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
      const VertexId end = forest.levelBegin[level + 1];
      for (VertexId begin = forest.levelBegin[level]; begin < end; begin += 100) {
        const VertexId stop = std::min(begin + 100, end);
        const auto count =
            decoder.decode(encodeLevelRun(forest, model, fronts, begin, stop), active);
        ASSERT_TRUE(count) << count.error().message;
        EXPECT_EQ(*count, stop - begin);
      }
    }
    EXPECT_EQ(active.splitsHeld(), forest.splitCount());
    expectEqualSoFar(forest, active);
  }
}

// From 11 to 18 bits a coordinate, at both ends of the grid.
TEST(SplitCodec, EveryGridComesBackExactly) {
  const TriangleMesh shape = primitives::bumpySphere(3, 3);
  std::int32_t largest = 1;
  for (const glm::ivec3& p : shape.positions)
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  for (int bits = 11; bits <= 18; ++bits) {
    TriangleMesh scaled = shape;
    const std::int64_t side = (std::int64_t{1} << bits) - 1;
    for (glm::ivec3& p : scaled.positions) {
      for (int axis = 0; axis < 3; ++axis)
        p[axis] = static_cast<std::int32_t>((p[axis] + largest) * side / (2 * largest));
    }
    const Placement placement = kPlacements[static_cast<std::size_t>(bits % 2)];
    const SplitForest forest = forestOf(scaled, placement);
    const LevelFronts fronts = frontsOf(forest);
    const SplitModel model = trainSplitModel(forest, fronts);
    SplitDecoder decoder(*parseSplitModel(serializeSplitModel(model), placement));
    ActiveMesh active = baseOf(forest);
    const std::uint32_t half = forest.levelCount() / 2;
    for (std::uint32_t level = 1; level < half; ++level) {
      const VertexId begin = forest.levelBegin[level];
      const VertexId end = forest.levelBegin[level + 1];
      ASSERT_TRUE(decoder.decode(encodeLevelRun(forest, model, fronts, begin, end), active));
    }
    std::vector<VertexId> rest;
    for (VertexId v = forest.levelBegin[half]; v < forest.vertexCount(); ++v)
      rest.push_back(v);
    ASSERT_TRUE(decoder.decode(encodeSplits(forest, model, rest), active));
    EXPECT_EQ(active.splitsHeld(), forest.splitCount());
    expectEqualSoFar(forest, active);
  }
}

TEST(SplitCodec, PacketsOfAnyLegalOrderDecode) {
  Rng rng(17);
  for (const SplitForest& forest : forests()) {
    const SplitModel model = modelOf(forest);
    ActiveMesh active = baseOf(forest);
    SplitDecoder decoder(model);
    const auto order = randomLegalOrder(forest, rng, OrderKind::kDepthFirst);
    for (std::size_t begin = 0; begin < order.size();) {
      const std::size_t end = std::min(order.size(), begin + 1 + rng.below(60));
      std::vector<VertexId> ids(
          order.begin() + static_cast<std::ptrdiff_t>(begin),
          order.begin() + static_cast<std::ptrdiff_t>(end));
      std::sort(ids.begin(), ids.end());
      ASSERT_TRUE(decoder.decode(encodeSplits(forest, model, ids), active));
      begin = end;
    }
    EXPECT_EQ(active.splitsHeld(), forest.splitCount());
    expectEqualSoFar(forest, active);
  }
}

// Some splits for the first time, some again, in runs of any size; the last grid is so fine that
// residuals are wide.
TEST(SplitCodec, PacketEncoderMakesTheSameBytesAsTheSlowOne) {
  Rng rng(19);
  auto meshes = shapes();
  meshes.push_back(primitives::bumpySphere(3, 3));
  for (glm::ivec3& p : meshes.back().positions)
    p *= 37;
  for (std::size_t i = 0; i < 2 * meshes.size(); ++i) {
    const SplitForest forest = forestOf(meshes[i / 2], kPlacements[i % 2]);
    const SplitModel model = modelOf(forest);
    PacketEncoder encoder(forest, model);
    for (int run = 0; run < 30; ++run) {
      std::vector<VertexId> ids;
      const std::uint32_t sparsity = 1 + rng.below(20);
      for (const VertexId v : allSplits(forest)) {
        if (rng.below(sparsity) == 0) ids.push_back(v);
      }
      ASSERT_EQ(encoder.encode(ids), encodeSplits(forest, model, ids));
    }
  }
}

TEST(SplitCodec, SymbolsOfAnySizeArePackedWhole) {
  for (const std::size_t tokens : {0U, 5U, 126U, 127U, 3000U}) {
    for (const std::int32_t residual : {0, 511, -512, 512, -513, 1 << 20}) {
      SplitSymbols symbols;
      std::vector<std::pair<std::uint32_t, bool>> bits;
      for (std::size_t i = 0; i < tokens; ++i) {
        bits.emplace_back(split_syntax::kOpenSide + i % 48, i % 3 == 0);
        symbols.code(bits.back().first, bits.back().second);
      }
      const std::array<std::int32_t, 3> residuals = {residual, -1, residual};
      const auto contextOf = [](std::uint32_t axis) {
        const std::uint32_t last = split_syntax::kScales - 1 - axis;
        return split_syntax::kResidual +
               (2 * last + (axis == 2 ? 1 : 0)) * split_syntax::kNumberContexts;
      };
      for (std::uint32_t axis = 0; axis < 3; ++axis)
        symbols.codeSigned(contextOf(axis), residuals[axis]);
      std::vector<std::uint8_t> packed;
      symbols.pack(packed);

      const SplitModel& model = defaultSplitModel();
      BinWriter slow(model.probabilities);
      for (const auto& [context, bit] : bits)
        slow.code(context, bit);
      for (std::uint32_t axis = 0; axis < 3; ++axis)
        split_syntax::codeSigned(slow, contextOf(axis), residuals[axis]);
      FastBinWriter fast;
      fast.begin(model.probabilities);
      SplitSymbols::replay(packed.data(), fast);
      std::vector<std::uint8_t> expected;
      std::vector<std::uint8_t> made;
      slow.finish(expected);
      fast.finish(made);
      EXPECT_EQ(made, expected) << tokens << " tokens, residual " << residual;
    }
  }
}

TEST(SplitCodec, UniversalModelHasEveryContextAndNothingToSay) {
  const SplitModel& model = defaultSplitModel();
  EXPECT_EQ(model.probabilities.size(), split_syntax::kContexts);
  EXPECT_EQ(std::ranges::count(model.probabilities, 0), 0);
  EXPECT_EQ(serializeSplitModel(model), std::vector<std::uint8_t>(49, 0));
}

TEST(SplitCodec, MeasuredModelsDecodeAsWellAndSmallModelsCostLittleMore) {
  const SplitForest forest = forestOf(primitives::bumpySphere(4, 3));
  const LevelFronts fronts = frontsOf(forest);
  const auto whole = encodeSplits(forest, measureSplitModel(forest, fronts), allSplits(forest));
  const SplitModel small = trainSplitModel(forest, fronts);
  EXPECT_LT(serializeSplitModel(small).size(), 300U);
  const auto bytes = encodeSplits(forest, small, allSplits(forest));
  EXPECT_LT(bytes.size(), whole.size() + whole.size() / 20);
  const SplitModel measured =
      *parseSplitModel(serializeSplitModel(measureSplitModel(forest, fronts)));
  ActiveMesh active = baseOf(forest);
  ASSERT_TRUE(SplitDecoder(measured).decode(whole, active));
  expectEqualSoFar(forest, active);
}

TEST(SplitCodec, ModelsSurviveSerialisationAndNoTruncationPasses) {
  for (const Placement placement : kPlacements) {
    const SplitModel model = modelOf(forestOf(primitives::icosphere(4), placement));
    EXPECT_EQ(model.placement, placement);
    const auto bytes = serializeSplitModel(model);
    const auto back = parseSplitModel(bytes, placement);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->probabilities, model.probabilities);
    EXPECT_EQ(back->weights, model.weights);
    EXPECT_EQ(back->moveWeights, model.moveWeights);
    for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
      EXPECT_FALSE(parseSplitModel(std::span(bytes).first(cut), placement)) << cut;
    }
    const bool moves = placement == Placement::kVolume;
    EXPECT_FALSE(parseSplitModel(bytes, moves ? Placement::kSubset : Placement::kVolume));
  }
}

bool mayApply(const SplitForest& forest, const ActiveMesh& active, VertexId v) {
  bool may = true;
  forest.forEachPrerequisite(v, [&](VertexId w) { may = may && active.holds(w); });
  return may;
}

// What a level run's names depend on must not depend on what finer splits a client has besides.
TEST(SplitCodec, FrontClassesAreTheSameWhateverElseIsHeld) {
  Rng rng(5);
  for (const SplitForest& forest : forests()) {
    const LevelFronts fronts = frontsOf(forest);
    for (std::uint32_t level = 1; level < forest.levelCount(); ++level) {
      ActiveMesh active = baseOf(forest);
      for (VertexId v = forest.baseVertexCount(); v < forest.levelBegin[level]; ++v)
        ASSERT_TRUE(active.apply(forest.split(v)));
      EXPECT_EQ(*frontClasses(active, level), fronts[level]);
      for (VertexId v = forest.levelBegin[level]; v < forest.vertexCount(); ++v) {
        if (rng.below(3) != 0 && mayApply(forest, active, v)) {
          ASSERT_TRUE(active.apply(forest.split(v)));
        }
      }
      EXPECT_EQ(*frontClasses(active, level), fronts[level]);
    }
    if (forest.levelCount() > 2) {
      EXPECT_FALSE(frontClasses(baseOf(forest), 2));
    }
  }
}

// A client that was sent finer splits for a view can still take whole levels.
TEST(SplitCodec, LevelRunsDecodeBesideFinerSplits) {
  const SplitForest forest = forestOf(primitives::bumpySphere(4, 3), Placement::kVolume);
  const LevelFronts fronts = frontsOf(forest);
  const SplitModel model = trainSplitModel(forest, fronts);
  ActiveMesh active = baseOf(forest);
  SplitDecoder decoder(model);
  const std::uint32_t level = forest.levelCount() - 2;
  for (VertexId v = forest.baseVertexCount(); v < forest.levelBegin[level]; ++v)
    ASSERT_TRUE(active.apply(forest.split(v)));
  const VertexId middle = (forest.levelBegin[level] + forest.levelBegin[level + 1]) / 2;
  const auto first = encodeLevelRun(forest, model, fronts, forest.levelBegin[level], middle);
  const auto second = encodeLevelRun(forest, model, fronts, middle, forest.levelBegin[level + 1]);
  const auto head = levelRunHead(second);
  ASSERT_TRUE(head);
  EXPECT_EQ(head->begin, middle);
  EXPECT_EQ(head->count, forest.levelBegin[level + 1] - middle);
  EXPECT_FALSE(levelRunHead(encodeSplits(forest, model, {})));
  // Out of order: what comes before it is missing.
  EXPECT_FALSE(decoder.decode(second, active));
  ASSERT_TRUE(decoder.decode(first, active));
  for (VertexId v = forest.levelBegin[level + 1]; v < forest.vertexCount(); ++v) {
    if (mayApply(forest, active, v)) {
      ASSERT_TRUE(active.apply(forest.split(v)));
    }
  }
  ASSERT_TRUE(SplitDecoder(model).decode(second, active));
  for (VertexId v = forest.levelBegin[level + 1]; v < forest.vertexCount(); ++v) {
    if (!active.holds(v)) {
      ASSERT_TRUE(active.apply(forest.split(v)));
    }
  }
  expectEqualSoFar(forest, active);
}

TEST(SplitCodec, DamagedLevelRunsLeaveAValidMesh) {
  const SplitForest forest = forestOf(primitives::torusKnot(2, 3, 120, 10));
  const LevelFronts fronts = frontsOf(forest);
  const SplitModel model = trainSplitModel(forest, fronts);
  const auto bytes =
      encodeLevelRun(forest, model, fronts, forest.levelBegin[1], forest.levelBegin[2]);
  Rng rng(29);
  for (int run = 0; run < 200; ++run) {
    auto damaged = bytes;
    if (run % 2 == 0) damaged.resize(rng.below(static_cast<std::uint32_t>(damaged.size())));
    for (int i = 0; i < 2 && !damaged.empty(); ++i) {
      damaged[rng.below(static_cast<std::uint32_t>(damaged.size()))] ^=
          static_cast<std::uint8_t>(1U << rng.below(8));
    }
    ActiveMesh active = baseOf(forest);
    if (damaged.size() < bytes.size()) {
      EXPECT_FALSE(SplitDecoder(model).decode(damaged, active));
    } else {
      EXPECT_LE(SplitDecoder(model).decode(damaged, active).value_or(0), forest.splitCount());
    }
    EXPECT_TRUE(validate(active.mesh()));
  }
}

// Whatever the bytes: an error or a valid mesh, never anything else.
TEST(SplitCodec, DamagedRunsLeaveAValidMesh) {
  const TriangleMesh knot = primitives::torusKnot(2, 3, 120, 10);
  const std::array<SplitForest, 2> both = {forestOf(knot), forestOf(knot, Placement::kVolume)};
  const std::array<SplitModel, 2> models = {modelOf(both[0]), modelOf(both[1])};
  const std::array<std::vector<std::uint8_t>, 2> bytes = {
      encodeSplits(both[0], models[0], allSplits(both[0])),
      encodeSplits(both[1], models[1], allSplits(both[1]))};
  Rng rng(23);
  for (int run = 0; run < 600; ++run) {
    const SplitForest& forest = both[static_cast<std::size_t>(run % 2)];
    const SplitModel& model = models[static_cast<std::size_t>(run % 2)];
    auto damaged = bytes[static_cast<std::size_t>(run % 2)];
    if (run / 2 % 2 == 0) {
      damaged.resize(rng.below(static_cast<std::uint32_t>(damaged.size())));
    }
    for (int i = 0; i < 3 && !damaged.empty(); ++i) {
      damaged[rng.below(static_cast<std::uint32_t>(damaged.size()))] ^=
          static_cast<std::uint8_t>(1U << rng.below(8));
    }
    ActiveMesh active = baseOf(forest);
    const auto count = SplitDecoder(model).decode(damaged, active);
    EXPECT_LE(count.value_or(0), forest.splitCount());
    if (run % 8 == 0) {
      const auto valid = validate(active.mesh());
      EXPECT_TRUE(valid) << valid.error().message;
    }
  }
}

TEST(SplitCodec, EveryTruncationIsAnError) {
  for (const Placement placement : kPlacements) {
    const SplitForest forest = forestOf(primitives::icosphere(3), placement);
    const SplitModel model = modelOf(forest);
    const auto bytes = encodeSplits(forest, model, allSplits(forest));
    for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
      ActiveMesh active = baseOf(forest);
      EXPECT_FALSE(SplitDecoder(model).decode(std::span(bytes).first(cut), active)) << cut;
    }
  }
}

}  // namespace
}  // namespace limn
