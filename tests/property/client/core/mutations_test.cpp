// SPDX-License-Identifier: Apache-2.0
#include "client/core/stream_decoder.h"
#include "tests/property/decorated.h"
#include "tests/property/mutate.h"
#include "tests/unit/client/core/small_asset.h"

#include "shared/codec/id_set.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

/// Gives a decoder whatever the bytes say. False when they were refused.
bool feed(StreamDecoder& decoder, protocol::Bytes bytes) {
  const auto message = protocol::decodeMessage(bytes, protocol::Sender::kServer);
  if (!message) return false;
  bool taken = false;
  std::visit(
      [&](const auto& body) {
        using T = std::decay_t<decltype(body)>;
        if constexpr (std::is_same_v<T, protocol::ModelInfo>) {
          taken = decoder.beginModel(body).has_value();
        } else if constexpr (requires { decoder.take(body); }) {
          taken = decoder.take(body).has_value();
        } else if constexpr (std::is_same_v<T, protocol::Dropped>) {
          const auto ids = decodeIdSet(body.kept, 1U << 27);
          taken = ids && decoder.undo(*ids).has_value();
        }
      },
      message->body);
  return taken;
}

// A stream with one damaged message: it is refused, or decodes to a mesh that is a manifold within
// its grid; what comes after it is refused or decodes as well.
void mutateStreamOf(const TriangleMesh& shape, int rounds) {
  const SmallAsset asset = makeSmallAsset(shape, 1, stripeSeams(shape));
  std::vector<std::vector<std::uint8_t>> stream{asset.info, asset.base};
  stream.insert(stream.end(), asset.blocks.begin(), asset.blocks.end());
  stream.insert(stream.end(), asset.packets.begin(), asset.packets.end());
  // The finest splits go again.
  const std::uint32_t vertices = asset.built.forest.vertexCount();
  std::vector<VertexId> finest;
  for (VertexId v = vertices - 8; v < vertices; ++v)
    finest.push_back(v);
  const auto ids = encodeIdSet(finest);
  stream.push_back(protocol::encodeMessage(protocol::Dropped{0, ids}));
  std::vector<StreamDecoder> before(1);
  for (const auto& message : stream) {
    StreamDecoder next = before.back();
    ASSERT_TRUE(feed(next, message)) << "message " << before.size();
    before.push_back(next);
  }
  Rng rng(77);
  int refused = 0;
  int taken = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::size_t at = rng.below(static_cast<std::uint32_t>(stream.size()));
    StreamDecoder decoder = before[at];
    (feed(decoder, mutated(stream[at], rng)) ? taken : refused) += 1;
    if (at + 1 < stream.size() && rng.below(4) == 0)
      static_cast<void>(feed(decoder, stream[at + 1]));
    if (!decoder.hasBase()) continue;
    const auto valid = validate(decoder.mesh().mesh());
    ASSERT_TRUE(valid) << valid.error().message;
    ASSERT_EQ(decoder.mesh().features().size(), decoder.mesh().mesh().origins.size());
    const AttributeArrays& attributes = decoder.mesh().attributes();
    ASSERT_TRUE(
        attributes.colors.empty() || attributes.colors.size() == decoder.mesh().ids().size());
    for (const OctNormal& normal : attributes.normals)
      ASSERT_LE(std::max(normal.x, normal.y), 2 * kOctRadius);
    for (const VertexId v : decoder.mesh().ids())
      ASSERT_TRUE(decoder.mesh().holds(v));
  }
  // Both must occur, else the mutations test nothing.
  EXPECT_GT(refused, rounds / 20);
  EXPECT_GT(taken, rounds / 200);
}

TEST(StreamMutations, AreRefusedOrLeaveAValidMesh) {
  mutateStreamOf(primitives::icosphere(2), mutationRounds(4000));
}

TEST(StreamMutations, OfModelsWithAttributesAreRefusedOrLeaveAValidMesh) {
  mutateStreamOf(decorated(primitives::icosphere(2), kAllAttributeKinds), mutationRounds(3000));
}

// Cut anywhere, a message is refused: no byte of a run or of its attributes can be done without.
TEST(StreamMutations, TruncatedAttributesAreRefused) {
  const TriangleMesh shape = decorated(primitives::icosphere(2), kAllAttributeKinds);
  const SmallAsset asset = makeSmallAsset(shape, 1, stripeSeams(shape));
  StreamDecoder whole;
  ASSERT_TRUE(feed(whole, asset.info));
  ASSERT_TRUE(feed(whole, asset.base));
  for (const auto& block : asset.blocks)
    ASSERT_TRUE(feed(whole, block));
  const auto message = protocol::decodeMessage(asset.packets[0], protocol::Sender::kServer);
  const protocol::Packet packet = *message->as<protocol::Packet>();
  ASSERT_FALSE(packet.attributes.empty());
  for (std::size_t size = 0; size < packet.attributes.size(); ++size) {
    protocol::Packet cut = packet;
    cut.attributes = packet.attributes.first(size);
    StreamDecoder decoder = whole;
    EXPECT_FALSE(decoder.take(cut)) << size;
    EXPECT_TRUE(validate(decoder.mesh().mesh()));
  }
  // And a model without attributes takes none.
  const SmallAsset plain = makeSmallAsset(primitives::icosphere(2));
  StreamDecoder decoder;
  ASSERT_TRUE(feed(decoder, plain.info));
  ASSERT_TRUE(feed(decoder, plain.base));
  for (const auto& block : plain.blocks)
    ASSERT_TRUE(feed(decoder, block));
  const auto plainMessage = protocol::decodeMessage(plain.packets[0], protocol::Sender::kServer);
  protocol::Packet more = *plainMessage->as<protocol::Packet>();
  more.attributes = packet.attributes;
  EXPECT_FALSE(decoder.take(more));
  EXPECT_TRUE(whole.take(packet));
}

}  // namespace
}  // namespace limn
