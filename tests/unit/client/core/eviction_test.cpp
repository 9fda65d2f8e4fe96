// SPDX-License-Identifier: Apache-2.0
#include "client/core/eviction.h"

#include "shared/mesh/vertex_attributes.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

constexpr std::uint32_t kBase = 400;
constexpr std::uint32_t kVertices = 400'000;

TEST(SplitsThatFit, FewerOfAModelWithAttributes) {
  const std::uint32_t plain = splitsThatFit(40'000'000, kBase, kVertices, 0);
  const std::uint32_t colored = splitsThatFit(40'000'000, kBase, kVertices, kAttributeColors);
  const std::uint32_t all = splitsThatFit(40'000'000, kBase, kVertices, kAllAttributeKinds);
  EXPECT_GT(plain, colored);
  EXPECT_GT(colored, all);
  EXPECT_GT(all, plain / 2);
}

TEST(SplitsThatFit, AreNoneOrAUsefulNumberAndNeverMoreThanThereAre) {
  EXPECT_EQ(splitsThatFit(0, kBase, kVertices, 0), 0U);
  EXPECT_EQ(splitsThatFit(1ULL << 40, kBase, kVertices, kAllAttributeKinds), kVertices);
  for (std::uint64_t bytes = 0; bytes < 20'000'000; bytes += 100'000) {
    const std::uint32_t splits = splitsThatFit(bytes, kBase, kVertices, kAllAttributeKinds);
    EXPECT_TRUE(splits == 0 || splits >= 256) << bytes;
  }
}

}  // namespace
}  // namespace limn
