// SPDX-License-Identifier: Apache-2.0
#include "protocol/section_hash.h"

#include <gtest/gtest.h>

#include <vector>

namespace limn::protocol {
namespace {

TEST(SectionHash, IsTheFirstHalfOfTheSha256OfBothParts) {
  const std::vector<std::uint8_t> abc = {'a', 'b', 'c'};
  const auto hash = sectionHash(abc);
  EXPECT_EQ(toHex(hash), "ba7816bf8f01cfea414140de5dae2223");
  EXPECT_EQ(sectionHash(std::span(abc).first(1), std::span(abc).subspan(1)), hash);
}

TEST(SectionHash, HasSixteenBytesOrIsNone) {
  const std::vector<std::uint8_t> bytes(17, 7);
  EXPECT_EQ(
      toSectionHash(std::span(bytes).first(16)),
      SectionHash({7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7}));
  EXPECT_FALSE(toSectionHash(bytes));
  EXPECT_FALSE(toSectionHash(std::span(bytes).first(15)));
  EXPECT_FALSE(toSectionHash({}));
}

}  // namespace
}  // namespace limn::protocol
