// SPDX-License-Identifier: Apache-2.0
#include "shared/core/sha256.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

// FIPS 180-4 example "abc", in one piece and in two.
TEST(Sha256, MatchesThePublishedVector) {
  const std::uint8_t text[] = {'a', 'b', 'c'};
  const std::string expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  EXPECT_EQ(toHex(sha256(text)), expected);
  const std::span<const std::uint8_t> pieces[] = {
      std::span(text).first(1),
      std::span(text).subspan(1)};
  EXPECT_EQ(toHex(sha256(pieces)), expected);
}

}  // namespace
}  // namespace limn
