// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/packing_queue.h"

#include <algorithm>

namespace limn {

void PackingQueue::push(std::uint32_t v, std::uint32_t unlocked) {
  waiting_[v] = static_cast<std::uint8_t>(std::min<std::size_t>(unlocked + 1, kClasses - 1));
  stacks_[waiting_[v]].push_back(v);
}

void PackingQueue::neighbourLocked(std::uint32_t v) {
  if (waiting_[v] > 1) stacks_[--waiting_[v]].push_back(v);
}

std::optional<std::uint32_t> PackingQueue::pop() {
  for (std::size_t k = 1; k < kClasses; ++k) {
    while (!stacks_[k].empty()) {
      const std::uint32_t v = stacks_[k].back();
      stacks_[k].pop_back();
      if (waiting_[v] != k) continue;
      waiting_[v] = 0;
      return v;
    }
  }
  return std::nullopt;
}

}  // namespace limn
