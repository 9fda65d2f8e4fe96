// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace limn {

/// The numbers 0 to count − 1 in sets that can only be joined, paths halved [Tarjan, van Leeuwen:
/// Worst-case analysis of set union algorithms, J. ACM 31(2), 1984]. Each set is known by one of
/// its numbers, its root, until it is joined to another. One thread: looking shortens paths. Cost:
/// a look or a join O(log count), amortised.
class DisjointSets {
 public:
  /// Each number in a set of its own.
  explicit DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0U);
  }

  [[nodiscard]] std::uint32_t rootOf(std::uint32_t number) {
    while (parents_[number] != number)
      number = parents_[number] = parents_[parents_[number]];
    return number;
  }

  /// The set of `number` becomes part of that of `into`, whose root stays.
  void join(std::uint32_t number, std::uint32_t into) { parents_[rootOf(number)] = rootOf(into); }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace limn
