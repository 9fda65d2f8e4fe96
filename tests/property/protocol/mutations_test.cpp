// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/protocol/samples.h"

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

// Flipped bits, overwritten bytes, lengths blown up, pieces cut out or repeated: a mutation decodes
// to something within the limits or is refused, and never reads outside its buffer.
TEST(MessageMutations, DecodeOrAreRefused) {
  Rng rng(2026);
  std::uint64_t refused = 0;
  std::uint64_t decoded = 0;
  const auto all = samples();
  for (int round = 0; round < 20'000; ++round) {
    const Sample& sample = all[rng.below(static_cast<std::uint32_t>(all.size()))];
    std::vector<std::uint8_t> bytes = sample.bytes;
    const std::uint32_t edits = 1 + rng.below(4);
    for (std::uint32_t e = 0; e < edits && !bytes.empty(); ++e) {
      const std::uint32_t at = rng.below(static_cast<std::uint32_t>(bytes.size()));
      switch (rng.below(5)) {
        case 0:
          bytes[at] ^= static_cast<std::uint8_t>(1U << rng.below(8));
          break;
        case 1:
          bytes[at] = static_cast<std::uint8_t>(rng.below(256));
          break;
        case 2:
          bytes[at] = 0xFF;
          break;
        case 3:
          bytes.erase(bytes.begin() + at);
          break;
        default:
          bytes.insert(bytes.begin() + at, bytes[at]);
          break;
      }
    }
    bytes.shrink_to_fit();
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
  EXPECT_GT(refused, 1000U);
  EXPECT_GT(decoded, 1000U);
}

}  // namespace
}  // namespace limn::protocol
