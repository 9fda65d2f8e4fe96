// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/packing_queue.h"

#include "shared/core/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace limn {
namespace {

TEST(PackingQueue, GivesTheFewestUnlockedFirstAndEachVertexOnce) {
  PackingQueue queue(10);
  queue.push(3, 6);
  queue.push(4, 5);
  queue.push(5, 6);
  queue.neighbourLocked(3);
  queue.neighbourLocked(3);
  queue.neighbourLocked(9);  // not waiting
  EXPECT_EQ(queue.pop(), 3U);
  EXPECT_EQ(queue.pop(), 4U);
  EXPECT_EQ(queue.pop(), 5U);
  EXPECT_EQ(queue.pop(), std::nullopt);
  queue.neighbourLocked(5);
  EXPECT_EQ(queue.pop(), std::nullopt);
}

// Against a map that is searched whole.
TEST(PackingQueue, AgreesWithAPlainSearch) {
  Rng rng(3);
  PackingQueue queue(200);
  std::map<std::uint32_t, std::uint32_t> waiting;
  for (int step = 0; step < 5000; ++step) {
    const std::uint32_t v = rng.below(200);
    const std::uint32_t action = rng.below(4);
    if (action == 0) {
      if (waiting.contains(v)) continue;
      waiting[v] = rng.below(12);
      queue.push(v, waiting[v]);
    } else if (action < 3) {
      queue.neighbourLocked(v);
      if (const auto found = waiting.find(v); found != waiting.end() && found->second > 0)
        --found->second;
    } else {
      const auto popped = queue.pop();
      ASSERT_EQ(popped.has_value(), !waiting.empty());
      if (!popped) continue;
      ASSERT_TRUE(waiting.contains(*popped));
      const auto fewest = std::min_element(waiting.begin(), waiting.end(), [](auto& a, auto& b) {
        return a.second < b.second;
      });
      EXPECT_EQ(waiting[*popped], fewest->second);
      waiting.erase(*popped);
    }
  }
}

}  // namespace
}  // namespace limn
