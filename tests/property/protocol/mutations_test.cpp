// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/protocol/samples.h"
#include "tests/property/mutate.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

namespace limn::protocol {
namespace {

/// Reads every byte that a decoded message points to, so that a sanitizer sees wild views.
std::uint64_t touch(const Message& message) {
  std::uint64_t sum = 0;
  for (const std::uint8_t byte : encodeMessage(message.body))
    sum += byte;
  return sum;
}

// A mutation decodes to something within the limits or is refused, and never reads outside its
// buffer.
TEST(MessageMutations, DecodeOrAreRefused) {
  Rng rng(2026);
  int refused = 0;
  int decoded = 0;
  const auto all = samples();
  const int rounds = mutationRounds(20'000);
  for (int round = 0; round < rounds; ++round) {
    const Sample& sample = all[rng.below(static_cast<std::uint32_t>(all.size()))];
    const std::vector<std::uint8_t> bytes = mutated(sample.bytes, rng);
    const auto message = decodeMessage(bytes, sample.sender);
    if (message) {
      touch(*message);
      ++decoded;
    } else {
      EXPECT_FALSE(message.error().message.empty());
      ++refused;
    }
  }
  // Both outcomes must occur, else the mutations test nothing.
  EXPECT_GT(refused, rounds / 20);
  EXPECT_GT(decoded, rounds / 20);
}

}  // namespace
}  // namespace limn::protocol
