// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <thread>
#include <vector>

namespace limn {

/// Calls work(begin, end) on disjoint pieces of [0, count) from `threads` threads and waits. The
/// pieces differ with the number of threads, so `work` must give each item the same result anyway.
template <class Work>
void parallelFor(std::uint32_t count, unsigned threads, Work work) {
  constexpr std::uint32_t kLeastPiece = 1024;
  const std::uint32_t pieces =
      std::clamp<std::uint32_t>(count / kLeastPiece, 1, std::max(1U, threads));
  std::vector<std::jthread> workers;
  const auto bound = [&](std::uint64_t i) {
    return static_cast<std::uint32_t>(i * count / pieces);
  };
  for (std::uint32_t i = 1; i < pieces; ++i) {
    workers.emplace_back([=] { work(bound(i), bound(i + 1)); });
  }
  work(0, bound(1));
}

}  // namespace limn
