// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace limn {

/// The order in which a level's candidates are tried: the one with the fewest unlocked neighbours
/// first, since that locks the fewest vertices and so leaves room for more collapses in the level.
/// (The greedy rule for large independent sets.) Deterministic: last in, first out among equals.
class PackingQueue {
 public:
  explicit PackingQueue(std::size_t vertexCount) : waiting_(vertexCount, 0) {}

  /// unlocked: neighbours of v that are not locked yet. v must not be waiting.
  void push(std::uint32_t v, std::uint32_t unlocked);

  /// To be told when a neighbour of v is locked; nothing happens when v is not waiting.
  void neighbourLocked(std::uint32_t v);

  /// Takes the next vertex; nullopt when none waits. Cost: O(1) amortised.
  [[nodiscard]] std::optional<std::uint32_t> pop();

 private:
  static constexpr std::size_t kClasses = 32;
  std::vector<std::uint8_t> waiting_;  // by vertex: 1 + unlocked neighbours; 0: not waiting
  std::array<std::vector<std::uint32_t>, kClasses> stacks_;  // with outdated entries
};

}  // namespace limn
