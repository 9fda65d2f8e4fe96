// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/bin_coder.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace limn {
namespace {

TEST(BinCoder, IsFinishedAfterTheLastBinHoweverUnlikely) {
  // Probabilities of 0 from the least to the most likely; every last bin, after every one before.
  for (int p = 1; p < 256; ++p) {
    const std::array<Probability, 2> probabilities = {
        static_cast<Probability>(p),
        static_cast<Probability>(128)};
    for (int pattern = 0; pattern < 8; ++pattern) {
      BinWriter writer(probabilities);
      for (int i = 0; i < 3; ++i)
        writer.code(i == 1 ? 1 : 0, (pattern >> i & 1) != 0);
      std::vector<std::uint8_t> bytes;
      writer.finish(bytes);
      BinReader reader(probabilities, bytes);
      for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(i == 0 && bytes.size() > 1 && reader.isFinished()) << "before the first bin";
        EXPECT_EQ(reader.code(i == 1 ? 1 : 0), (pattern >> i & 1) != 0);
      }
      EXPECT_TRUE(reader.isFinished()) << "p " << p << ", bits " << pattern;
    }
  }
}

TEST(BinCoder, AdaptiveAndRawBitsComeBackInAnyMixture) {
  Rng rng(3);
  for (int run = 0; run < 50; ++run) {
    std::vector<Probability> table(20);
    for (Probability& p : table)
      p = static_cast<Probability>(1 + rng.below(255));

    struct Item {
      std::uint32_t context;  // 20 and more: raw bits
      std::uint32_t value;
    };

    std::vector<Item> items;
    const std::uint32_t count = rng.below(3000);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t context = rng.below(32);
      const bool raw = context >= 20;
      items.push_back(
          {context, raw ? rng.below(1U << (context - 19)) : (rng.below(9) == 0 ? 1U : 0U)});
    }
    BinWriter writer(table);
    for (const Item& item : items) {
      if (item.context < 20) {
        writer.code(item.context, item.value != 0);
      } else {
        writer.codeRaw(item.context - 19, item.value);
      }
    }
    std::vector<std::uint8_t> bytes;
    writer.finish(bytes);
    BinReader reader(table, bytes);
    ASSERT_TRUE(reader.isValid());
    for (const Item& item : items) {
      const std::uint32_t value = item.context < 20 ? std::uint32_t{reader.code(item.context)}
                                                    : reader.codeRaw(item.context - 19);
      ASSERT_EQ(value, item.value);
    }
    EXPECT_TRUE(reader.isFinished());
  }
}

// Followed for long enough, a bit that never changes costs next to nothing, whatever the table
// said.
TEST(BinCoder, FollowsWhatIsCoded) {
  const std::array<Probability, 1> table = {1};
  BinWriter writer(table);
  for (int i = 0; i < 100'000; ++i)
    writer.code(0, false);
  std::vector<std::uint8_t> bytes;
  writer.finish(bytes);
  EXPECT_LT(bytes.size(), 100U);
}

}  // namespace
}  // namespace limn
