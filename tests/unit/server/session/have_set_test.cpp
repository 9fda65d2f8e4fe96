// SPDX-License-Identifier: Apache-2.0
#include "server/session/have_set.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <set>

namespace limn {
namespace {

TEST(HaveSet, AgreesWithASetOfIntegers) {
  Rng rng(1);
  constexpr std::uint32_t kVertices = 203;  // no multiple of 64
  HaveSet have(kVertices);
  std::set<VertexId> truth;
  for (int step = 0; step < 2000; ++step) {
    const VertexId v = rng.below(kVertices);
    if (rng.below(3) == 0) {
      have.remove(v);
      truth.erase(v);
    } else {
      have.add(v);
      truth.insert(v);
    }
    ASSERT_EQ(have.count(), truth.size());
    const VertexId begin = rng.below(kVertices + 1);
    const VertexId end = begin + rng.below(kVertices + 1 - begin);
    const auto expected = std::distance(truth.lower_bound(begin), truth.lower_bound(end));
    ASSERT_EQ(have.countRange(begin, end), static_cast<std::uint32_t>(expected));
  }
  for (VertexId v = 0; v < kVertices; ++v)
    EXPECT_EQ(have.holds(v), truth.contains(v));
}

TEST(HaveSet, TakesPiecesOfBitsInAndIgnoresThePast) {
  HaveSet have(21);
  have.addBits(8, std::vector<std::uint8_t>{0b00000101, 0xFF, 0xFF});
  EXPECT_TRUE(have.holds(8));
  EXPECT_FALSE(have.holds(9));
  EXPECT_TRUE(have.holds(10));
  EXPECT_TRUE(have.holds(16));
  EXPECT_EQ(have.count(), 2U + 5U) << "21 vertices: bits from 21 on are ignored";
  have.addBits(8, std::vector<std::uint8_t>{0b00000101});
  EXPECT_EQ(have.count(), 7U) << "the same again changes nothing";
  have.addRange(0, 21);
  EXPECT_TRUE(have.complete());
}

TEST(HaveSet, TakesABitAVertex) {
  EXPECT_LE(HaveSet(1'000'000).bytes(), 1'000'000 / 8 + 8U);
}

}  // namespace
}  // namespace limn
