// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/fast_bin_writer.h"

#include "shared/codec/split_syntax.h"
#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace limn {
namespace {

using split_syntax::kNumberContexts;

// What both writers make of the same calls.
class Both {
 public:
  explicit Both(std::span<const Probability> table) : slow_(table) { fast_.begin(table); }

  template <class Call>
  void operator()(const Call& call) {
    call(slow_);
    call(fast_);
  }

  void expectSame() {
    std::vector<std::uint8_t> slow{7};
    std::vector<std::uint8_t> fast{7};
    slow_.finish(slow);
    fast_.finish(fast);
    ASSERT_EQ(slow, fast);
  }

  FastBinWriter& fast() { return fast_; }

 private:
  BinWriter slow_;
  FastBinWriter fast_;
};

std::vector<Probability> randomTable(std::size_t contexts, Rng& rng) {
  std::vector<Probability> table(contexts);
  for (Probability& p : table)
    p = static_cast<Probability>(1 + rng.below(255));
  return table;
}

TEST(FastBinWriter, WritesWhatTheSlowOneWrites) {
  constexpr std::uint32_t kBits = 8 * kNumberContexts;  // contexts of bits that are no number's
  Rng rng(5);
  for (int run = 0; run < 40; ++run) {
    const auto table = randomTable(9 * kNumberContexts, rng);
    Both both(table);
    const std::uint32_t count = rng.below(4000);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t context = kNumberContexts * rng.below(8);
      // Numbers of every length, short ones most.
      const std::uint32_t bits = rng.below(4) == 0 ? rng.below(31) : rng.below(6);
      const std::uint32_t value = rng.below(1U << bits);
      switch (rng.below(4)) {
        case 0:
          both([&](auto& bins) { bins.code(kBits + value % 32, (value & 1) != 0); });
          break;
        case 1:
          both([&](auto& bins) { bins.codeRaw(bits % 13, value & ((1U << bits % 13) - 1)); });
          break;
        case 2:
          both([&](auto& bins) { split_syntax::codeNumber(bins, context, value); });
          break;
        default:
          both([&](auto& bins) {
            split_syntax::codeSigned(
                bins,
                context,
                i % 2 == 0 ? static_cast<std::int32_t>(value) : -static_cast<std::int32_t>(value));
          });
      }
    }
    both.expectSame();
  }
}

// Bits so unlikely, again and again, that every state that a context can reach is passed.
TEST(FastBinWriter, FollowsContextsToTheirEnds) {
  const std::array<Probability, 2> table = {1, 255};
  for (const bool bit : {false, true}) {
    Both both(table);
    for (int i = 0; i < 2000; ++i) {
      both([&](auto& bins) {
        bins.code(0, i < 1000 ? bit : !bit);
        bins.code(1, i < 1000 ? !bit : bit);
      });
    }
    both.expectSame();
  }
}

TEST(FastBinWriter, StartsAfreshWithEveryStream) {
  Rng rng(6);
  const auto table = randomTable(kNumberContexts, rng);
  FastBinWriter writer;
  std::vector<std::vector<std::uint8_t>> streams(2);
  for (auto& stream : streams) {
    writer.begin(table);
    for (std::uint32_t i = 0; i < 300; ++i)
      writer.codeNumber(0, i % 40);
    writer.finish(stream);
  }
  EXPECT_EQ(streams[0], streams[1]);
}

TEST(FastBinWriter, TokensAreBitsInContexts) {
  Rng rng(7);
  const auto table = randomTable(100, rng);
  std::vector<std::uint8_t> tokens;
  for (int i = 0; i < 500; ++i)
    tokens.push_back(static_cast<std::uint8_t>(rng.below(128)));
  BinWriter slow(table);
  for (const std::uint8_t token : tokens)
    slow.code(20 + (token >> 1), (token & 1) != 0);
  FastBinWriter fast;
  fast.begin(table);
  fast.codeTokens(20, tokens);
  std::vector<std::uint8_t> expected;
  std::vector<std::uint8_t> made;
  slow.finish(expected);
  fast.finish(made);
  EXPECT_EQ(made, expected);
}

}  // namespace
}  // namespace limn
