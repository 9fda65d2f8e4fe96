// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/bin_coder.h"

#include <gtest/gtest.h>

#include <array>

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

}  // namespace
}  // namespace limn
