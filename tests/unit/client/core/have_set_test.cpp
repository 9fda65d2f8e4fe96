// SPDX-License-Identifier: Apache-2.0
#include "client/core/have_set.h"

#include "tests/unit/client/core/small_asset.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(HaveSet, PiecesNameExactlyTheHeldVertices) {
  const SmallAsset asset = makeSmallAsset(primitives::icosphere(3));
  StreamDecoder decoder;
  const auto message = [](const std::vector<std::uint8_t>& bytes) {
    return protocol::decodeMessage(bytes, protocol::Sender::kServer);
  };
  ASSERT_TRUE(decoder.beginModel(*message(asset.info)->as<protocol::ModelInfo>()));
  {
    const auto empty = encodeHaveSet(decoder, 0);
    ASSERT_EQ(empty.size(), 1U);
    const auto piece = protocol::decodeMessage(empty[0], protocol::Sender::kClient);
    EXPECT_FALSE(piece->as<protocol::HaveSet>()->base);
    EXPECT_TRUE(piece->as<protocol::HaveSet>()->last);
    EXPECT_TRUE(piece->as<protocol::HaveSet>()->bits.empty());
  }
  ASSERT_TRUE(decoder.take(*message(asset.base)->as<protocol::Base>()));
  for (const auto& block : asset.blocks) {
    ASSERT_TRUE(decoder.take(*message(block)->as<protocol::LevelBlock>()));
  }
  ASSERT_TRUE(decoder.take(*message(asset.packets.front())->as<protocol::Packet>()));

  std::vector<bool> named(decoder.model().vertices, false);
  const auto pieces = encodeHaveSet(decoder, 9, 4);
  ASSERT_GT(pieces.size(), 1U);
  std::uint32_t next = 0;
  for (const auto& bytes : pieces) {
    const auto decoded = protocol::decodeMessage(bytes, protocol::Sender::kClient);
    ASSERT_TRUE(decoded) << decoded.error().message;
    const auto& piece = *decoded->as<protocol::HaveSet>();
    EXPECT_EQ(piece.channel, 9);
    EXPECT_TRUE(piece.base);
    EXPECT_EQ(piece.asset, asset.id);
    EXPECT_EQ(piece.first, next);
    EXPECT_EQ(piece.last, &bytes == &pieces.back());
    next += static_cast<std::uint32_t>(8 * piece.bits.size());
    for (std::size_t i = 0; i < 8 * piece.bits.size(); ++i) {
      if ((piece.bits[i / 8] >> (i % 8) & 1) != 0) named.at(piece.first + i) = true;
    }
  }
  for (VertexId v = 0; v < named.size(); ++v)
    EXPECT_EQ(named[v], decoder.mesh().holds(v)) << v;
}

}  // namespace
}  // namespace limn
