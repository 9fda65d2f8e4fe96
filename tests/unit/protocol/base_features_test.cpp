// SPDX-License-Identifier: Apache-2.0
#include "protocol/base_features.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

namespace limn::protocol {
namespace {

TEST(BaseFeatures, NoFeaturesTakeNoBytes) {
  EXPECT_TRUE(packBaseFeatures(std::vector<std::uint8_t>(300, 0)).empty());
  EXPECT_TRUE(unpackBaseFeatures({}, 300)->empty());
}

TEST(BaseFeatures, ComeBackAsTheyWere) {
  Rng rng(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::uint8_t> features(3 * (1 + rng.below(400)), 0);
    features[rng.below(static_cast<std::uint32_t>(features.size()))] = 3;
    for (auto& f : features) {
      if (rng.below(1 + round) == 0) f = static_cast<std::uint8_t>(1 + rng.below(3));
    }
    const auto bytes = packBaseFeatures(features);
    const auto back = unpackBaseFeatures(bytes, static_cast<std::uint32_t>(features.size()));
    ASSERT_TRUE(back);
    EXPECT_EQ(*back, features);
  }
}

TEST(BaseFeatures, AnyBytesDecodeOrAreRefused) {
  Rng rng(6);
  for (int round = 0; round < 5000; ++round) {
    std::vector<std::uint8_t> bytes(1 + rng.below(12));
    for (auto& b : bytes)
      b = static_cast<std::uint8_t>(rng.below(256));
    const auto features = unpackBaseFeatures(bytes, 90);
    if (features) {
      EXPECT_EQ(features->size(), 90U);
    }
  }
  EXPECT_FALSE(unpackBaseFeatures(std::vector<std::uint8_t>{0x80}, 90));       // cut short
  EXPECT_FALSE(unpackBaseFeatures(std::vector<std::uint8_t>{0x04}, 90));       // no bits
  EXPECT_FALSE(unpackBaseFeatures(std::vector<std::uint8_t>{0x05, 0x05}, 3));  // past the end
  EXPECT_FALSE(unpackBaseFeatures(std::vector<std::uint8_t>(9, 0xFF), 90));    // too long
}

}  // namespace
}  // namespace limn::protocol
