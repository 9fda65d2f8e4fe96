// SPDX-License-Identifier: Apache-2.0
#include "client/core/stream_decoder.h"
#include "tests/property/canonical_mesh.h"
#include "tests/property/decorated.h"
#include "tests/property/legal_order.h"
#include "tests/unit/client/core/small_asset.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace limn {
namespace {

/// Cuts a legal order into runs that may each be sorted by id and still be legal: a split goes to
/// the present run as long as its prerequisites came before the run, or are in it (then their ids
/// are smaller, being of coarser levels).
std::vector<std::vector<VertexId>> runsOf(const std::vector<VertexId>& order, Rng& rng) {
  std::vector<std::vector<VertexId>> runs;
  for (std::size_t i = 0; i < order.size();) {
    const std::size_t size = std::min<std::size_t>(1 + rng.below(200), order.size() - i);
    std::vector<VertexId> run(
        order.begin() + static_cast<std::ptrdiff_t>(i),
        order.begin() + static_cast<std::ptrdiff_t>(i + size));
    std::sort(run.begin(), run.end());
    runs.push_back(std::move(run));
    i += size;
  }
  return runs;
}

// A server may choose any legal order; a client always ends in the prepared mesh, and holds a
// manifold on the way.
TEST(StreamDecoderProperty, AnyLegalOrderEndsInThePreparedMesh) {
  const TriangleMesh shapes[] = {
      primitives::torusKnot(2, 3, 100, 8),
      primitives::bumpySphere(3, 5),
      primitives::openGrid(24, 20),
      decorated(primitives::torusKnot(2, 3, 80, 8), kAllAttributeKinds),
      decorated(primitives::openGrid(24, 20), kAttributeColors | kAttributeNormals)};
  Rng rng(11);
  for (const TriangleMesh& shape : shapes) {
    const SmallAsset asset = makeSmallAsset(shape, 1, stripeSeams(shape));
    const SplitForest& forest = asset.built.forest;
    ActiveMesh prepared = baseMeshOf(forest);
    for (VertexId v = forest.baseVertexCount(); v < forest.vertexCount(); ++v)
      ASSERT_TRUE(prepared.apply(forest.split(v)));
    const auto seamsOf = [](std::span<const std::uint8_t> features) {
      return std::count_if(features.begin(), features.end(), [](std::uint8_t f) {
        return (f & kFeatureSeam) != 0;
      });
    };
    EXPECT_EQ(seamsOf(prepared.features()), seamsOf(stripeSeams(shape)));
    for (const OrderKind kind : {OrderKind::kUniform, OrderKind::kDepthFirst}) {
      StreamDecoder decoder;
      const auto info = protocol::decodeMessage(asset.info, protocol::Sender::kServer);
      ASSERT_TRUE(decoder.beginModel(*info->as<protocol::ModelInfo>()));
      const auto base = protocol::decodeMessage(asset.base, protocol::Sender::kServer);
      ASSERT_TRUE(decoder.take(*base->as<protocol::Base>()));
      for (const auto& run : runsOf(randomLegalOrder(asset.built.forest, rng, kind), rng)) {
        const auto bytes = asset.packet(1, run);
        const auto packet = protocol::decodeMessage(bytes, protocol::Sender::kServer);
        ASSERT_TRUE(packet);
        const auto taken = decoder.take(*packet->as<protocol::Packet>());
        ASSERT_TRUE(taken) << taken.error().message;
        if (rng.below(8) == 0) {
          ASSERT_TRUE(validate(decoder.mesh().mesh()));
        }
      }
      EXPECT_TRUE(decoder.complete());
      EXPECT_TRUE(isWhole(asset, decoder.mesh()));
      EXPECT_EQ(canonicalOf(decoder.mesh()), canonicalOf(prepared));
    }
  }
}

}  // namespace
}  // namespace limn
