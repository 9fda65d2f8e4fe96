// SPDX-License-Identifier: Apache-2.0
#include "client/core/eviction.h"

#include "shared/mesh/vertex_attributes.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

constexpr std::uint32_t kBase = 400;
constexpr std::uint32_t kVertices = 400'000;

std::uint32_t splitsThatFit(
    std::uint64_t bytes,
    std::uint8_t attributes,
    Placement placement = Placement::kSubset) {
  protocol::ModelInfo model;
  model.vertices = kVertices;
  model.levelBegin = {0, kBase, kVertices};
  model.attributes = attributes;
  model.placement = static_cast<std::uint8_t>(placement);
  return limn::splitsThatFit(bytes, model);
}

TEST(SplitsThatFit, FewerOfAModelWithAttributesOrMoves) {
  const std::uint32_t plain = splitsThatFit(40'000'000, 0);
  const std::uint32_t colored = splitsThatFit(40'000'000, kAttributeColors);
  const std::uint32_t all = splitsThatFit(40'000'000, kAllAttributeKinds);
  EXPECT_GT(plain, colored);
  EXPECT_GT(colored, all);
  EXPECT_GT(all, plain / 2);
  const std::uint32_t moving = splitsThatFit(40'000'000, 0, Placement::kVolume);
  EXPECT_GT(plain, moving);
  EXPECT_GT(moving, plain / 2);
}

TEST(SplitsThatFit, AreNoneOrAUsefulNumberAndNeverMoreThanThereAre) {
  EXPECT_EQ(splitsThatFit(0, 0), 0U);
  EXPECT_EQ(splitsThatFit(1ULL << 40, kAllAttributeKinds), kVertices);
  for (std::uint64_t bytes = 0; bytes < 20'000'000; bytes += 100'000) {
    const std::uint32_t splits = splitsThatFit(bytes, kAllAttributeKinds);
    EXPECT_TRUE(splits == 0 || splits >= 256) << bytes;
  }
}

}  // namespace
}  // namespace limn
