// SPDX-License-Identifier: Apache-2.0
#include "server/session/packet_maker.h"

#include "tests/property/decorated.h"
#include "tests/unit/server/session/test_model.h"

#include "shared/codec/attribute_codec.h"
#include "shared/codec/split_codec.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

namespace limn {
namespace {

/// Every step-th split, from an offset.
std::vector<VertexId> some(const SplitForest& forest, std::uint32_t offset, std::uint32_t step) {
  std::vector<VertexId> ids;
  for (VertexId v = forest.baseVertexCount() + offset; v < forest.vertexCount(); v += step)
    ids.push_back(v);
  return ids;
}

CodedSplits codedBy(const Model& model, const std::vector<VertexId>& ids) {
  return {
      encodeSplits(model.forest(), model.splitModel(), ids),
      encodeAttributes(model.forest(), ids)};
}

TEST(PacketMaker, GivesEveryoneTheSamePacketOfTheSameSplits) {
  const auto model = modelOf(decorated(primitives::icosphere(4), kAllAttributeKinds));
  const SplitForest& forest = model->forest();
  PacketMaker packets(forest, model->splitModel());
  const auto ids = some(forest, 0, 3);
  const auto first = packets.packet(ids);
  EXPECT_EQ(*first, codedBy(*model, ids));
  EXPECT_FALSE(first->attributes.empty());
  EXPECT_EQ(packets.packet(ids), first);
  EXPECT_EQ(packets.hits(), 1U);
  EXPECT_NE(packets.packet(some(forest, 1, 3)), first);
  EXPECT_EQ(packets.hits(), 1U);
}

TEST(PacketMaker, ForgetsPacketsBeyondItsBounds) {
  const auto model = modelOf(primitives::icosphere(4));
  const SplitForest& forest = model->forest();
  PacketMaker unbounded(forest, model->splitModel(), 0);
  constexpr std::size_t kBytes = 20'000;
  PacketMaker packets(forest, model->splitModel(), kBytes);
  for (std::uint32_t offset = 0; offset < 100; ++offset)
    static_cast<void>(unbounded.packet(some(forest, offset, 7)));
  const auto kept = packets.packet(some(forest, 0, 7));
  for (std::uint32_t offset = 1; offset < 100; ++offset) {
    static_cast<void>(packets.packet(some(forest, offset, 7)));
    EXPECT_EQ(packets.packet(some(forest, 0, 7)), kept) << "used again and again";
  }
  EXPECT_LE(packets.bytes(), unbounded.bytes() + kBytes);
  const std::uint64_t hits = packets.hits();
  static_cast<void>(packets.packet(some(forest, 1, 7)));
  EXPECT_EQ(packets.hits(), hits) << "forgotten";
}

TEST(PacketMaker, ServesSeveralThreads) {
  const auto model = modelOf(primitives::icosphere(4));
  const SplitForest& forest = model->forest();
  PacketMaker& packets = model->packets();
  const auto check = [&](std::uint32_t first) {
    for (std::uint32_t offset = first; offset < 40; ++offset) {
      const auto ids = some(forest, offset, 11);
      EXPECT_EQ(*packets.packet(ids), codedBy(*model, ids));
    }
  };
  std::thread other(check, 0);
  check(10);
  other.join();
}

}  // namespace
}  // namespace limn
