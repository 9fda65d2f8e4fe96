// SPDX-License-Identifier: Apache-2.0
#include "shared/core/disjoint_sets.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace limn {
namespace {

TEST(DisjointSets, AreThoseThatRelabellingMakes) {
  constexpr std::uint32_t kCount = 200;
  DisjointSets sets(kCount);
  std::vector<std::uint32_t> labels(kCount);
  std::iota(labels.begin(), labels.end(), 0U);
  Rng rng(7);
  for (int joined = 0; joined < 150; ++joined) {
    const auto a = static_cast<std::uint32_t>(rng.uniform() * kCount);
    const auto b = static_cast<std::uint32_t>(rng.uniform() * kCount);
    const std::uint32_t root = sets.rootOf(b);
    sets.join(a, b);
    EXPECT_EQ(sets.rootOf(a), root);
    std::replace(labels.begin(), labels.end(), std::uint32_t{labels[a]}, std::uint32_t{labels[b]});
  }
  for (std::uint32_t a = 0; a < kCount; ++a) {
    for (std::uint32_t b = 0; b < kCount; ++b)
      ASSERT_EQ(sets.rootOf(a) == sets.rootOf(b), labels[a] == labels[b]) << a << " " << b;
  }
}

}  // namespace
}  // namespace limn
