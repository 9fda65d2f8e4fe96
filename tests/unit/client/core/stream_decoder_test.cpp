// SPDX-License-Identifier: Apache-2.0
#include "client/core/stream_decoder.h"

#include "tests/unit/client/core/small_asset.h"

#include "shared/core/rng.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

const SmallAsset& knot() {
  static const SmallAsset asset = makeSmallAsset(primitives::torusKnot(2, 3, 120, 10));
  return asset;
}

Result<void> feed(StreamDecoder& decoder, const std::vector<std::uint8_t>& bytes) {
  const auto message = protocol::decodeMessage(bytes, protocol::Sender::kServer);
  if (!message) return tl::unexpected(message.error());
  if (const auto* info = message->as<protocol::ModelInfo>()) return decoder.beginModel(*info);
  if (const auto* base = message->as<protocol::Base>()) return decoder.take(*base);
  if (const auto* block = message->as<protocol::LevelBlock>()) return decoder.take(*block);
  if (const auto* packet = message->as<protocol::Packet>()) return decoder.take(*packet);
  if (const auto* seeds = message->as<protocol::Seeds>()) return decoder.take(*seeds);
  return fail(ErrorCode::kProtocol, "not for a decoder");
}

/// A decoder that has taken everything up to the packets.
StreamDecoder upToBlocks(const SmallAsset& asset) {
  StreamDecoder decoder;
  EXPECT_TRUE(feed(decoder, asset.info));
  EXPECT_TRUE(feed(decoder, asset.base));
  for (const auto& block : asset.blocks)
    EXPECT_TRUE(feed(decoder, block));
  return decoder;
}

TEST(StreamDecoder, TheWholeStreamIsThePreparedMesh) {
  StreamDecoder decoder = upToBlocks(knot());
  EXPECT_FALSE(decoder.complete());
  for (const auto& packet : knot().packets) {
    const auto taken = feed(decoder, packet);
    ASSERT_TRUE(taken) << taken.error().message;
  }
  EXPECT_TRUE(decoder.complete());
  EXPECT_TRUE(isWhole(knot(), decoder.mesh()));
  EXPECT_TRUE(validate(decoder.mesh().mesh()));
}

TEST(StreamDecoder, RefusesDataBeforeItsBase) {
  StreamDecoder decoder;
  EXPECT_EQ(feed(decoder, knot().base).error().code, ErrorCode::kProtocol);
  ASSERT_TRUE(feed(decoder, knot().info));
  EXPECT_EQ(feed(decoder, knot().blocks.front()).error().code, ErrorCode::kProtocol);
  EXPECT_EQ(feed(decoder, knot().packets.front()).error().code, ErrorCode::kProtocol);
  ASSERT_TRUE(feed(decoder, knot().base));
  EXPECT_EQ(feed(decoder, knot().base).error().code, ErrorCode::kProtocol);
}

TEST(StreamDecoder, RefusesASplitThatItHolds) {
  StreamDecoder decoder = upToBlocks(knot());
  ASSERT_TRUE(feed(decoder, knot().packets.front()));
  EXPECT_FALSE(feed(decoder, knot().packets.front()));
  EXPECT_TRUE(validate(decoder.mesh().mesh()));
}

TEST(StreamDecoder, ASnapshotStaysAsItWas) {
  StreamDecoder decoder = upToBlocks(knot());
  const auto before = decoder.snapshot();
  const std::uint32_t faces = before->mesh.mesh().faceCount();
  for (const auto& packet : knot().packets)
    ASSERT_TRUE(feed(decoder, packet));
  EXPECT_EQ(before->mesh.mesh().faceCount(), faces);
  EXPECT_GT(decoder.snapshot()->revision, before->revision);
  EXPECT_GT(decoder.snapshot()->mesh.mesh().faceCount(), faces);
}

TEST(StreamDecoder, TheSameAssetAgainKeepsTheMeshAnotherOneDropsIt) {
  StreamDecoder decoder = upToBlocks(knot());
  const std::uint32_t held = decoder.mesh().splitsHeld();
  ASSERT_TRUE(feed(decoder, knot().info));
  EXPECT_EQ(decoder.mesh().splitsHeld(), held);
  const SmallAsset other = makeSmallAsset(primitives::icosphere(3), 2);
  ASSERT_TRUE(feed(decoder, other.info));
  EXPECT_FALSE(decoder.hasBase());
}

// Whatever was cut off, the mesh that remains is a manifold.
TEST(StreamDecoder, EveryTruncationOfAPacketIsRefusedOrShort) {
  const SmallAsset& asset = knot();
  const auto message = protocol::decodeMessage(asset.packets.front(), protocol::Sender::kServer);
  const protocol::Bytes splits = message->as<protocol::Packet>()->splits;
  const std::size_t step = std::max<std::size_t>(1, splits.size() / 200);
  for (std::size_t size = 1; size < splits.size(); size += step) {
    StreamDecoder decoder = upToBlocks(asset);
    const std::vector<std::uint8_t> cut(
        splits.begin(),
        splits.begin() + static_cast<std::ptrdiff_t>(size));
    (void)decoder.take(protocol::Packet{0, 1, cut});
    ASSERT_TRUE(validate(decoder.mesh().mesh())) << size;
  }
}

TEST(StreamDecoder, EveryTruncationOfTheBaseIsRefused) {
  const SmallAsset& asset = knot();
  const auto message = protocol::decodeMessage(asset.base, protocol::Sender::kServer);
  const protocol::Bytes draco = message->as<protocol::Base>()->draco;
  for (std::size_t size = 1; size < draco.size(); ++size) {
    StreamDecoder decoder;
    ASSERT_TRUE(feed(decoder, asset.info));
    const std::vector<std::uint8_t> cut(
        draco.begin(),
        draco.begin() + static_cast<std::ptrdiff_t>(size));
    (void)decoder.take(protocol::Base{0, cut, {}});
    if (decoder.hasBase()) {
      ASSERT_TRUE(validate(decoder.mesh().mesh())) << size;
    }
  }
}

TEST(StreamDecoder, DamagedPacketsLeaveAValidMesh) {
  const SmallAsset& asset = knot();
  const auto message = protocol::decodeMessage(asset.packets.front(), protocol::Sender::kServer);
  const protocol::Bytes splits = message->as<protocol::Packet>()->splits;
  Rng rng(7);
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<std::uint8_t> damaged(splits.begin(), splits.end());
    for (int e = 0; e < 3; ++e) {
      damaged[rng.below(static_cast<std::uint32_t>(damaged.size()))] ^=
          static_cast<std::uint8_t>(1U << rng.below(8));
    }
    StreamDecoder decoder = upToBlocks(asset);
    refused += decoder.take(protocol::Packet{0, 1, damaged}) ? 0 : 1;
    ASSERT_TRUE(validate(decoder.mesh().mesh())) << round;
  }
  EXPECT_GT(refused, 0);
}

TEST(StreamDecoder, ABaseOffTheGridIsRefused) {
  const auto message = protocol::decodeMessage(knot().info, protocol::Sender::kServer);
  protocol::ModelInfo info = *message->as<protocol::ModelInfo>();
  info.gridBits = 11;  // the shapes are on a 14-bit grid
  StreamDecoder decoder;
  ASSERT_TRUE(decoder.beginModel(info));
  EXPECT_EQ(feed(decoder, knot().base).error().code, ErrorCode::kCorrupt);
}

TEST(StreamDecoder, TooFewFacesInTheEndIsCorrupt) {
  const auto message = protocol::decodeMessage(knot().info, protocol::Sender::kServer);
  protocol::ModelInfo info = *message->as<protocol::ModelInfo>();
  info.faces += 2;
  StreamDecoder decoder;
  ASSERT_TRUE(decoder.beginModel(info));
  ASSERT_TRUE(feed(decoder, knot().base));
  for (const auto& block : knot().blocks)
    ASSERT_TRUE(feed(decoder, block));
  bool refused = false;
  for (const auto& packet : knot().packets)
    refused = !feed(decoder, packet);
  EXPECT_TRUE(refused);
}

}  // namespace
}  // namespace limn
