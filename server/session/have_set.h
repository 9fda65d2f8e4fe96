// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/ids.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Which vertices of a model a client holds: a bit a vertex id, base vertices included, lowest bit
/// of word 0 first. What was sent counts as held: the transport is reliable and ordered.
class HaveSet {
 public:
  HaveSet() = default;
  explicit HaveSet(std::uint32_t vertexCount);

  [[nodiscard]] std::uint32_t vertexCount() const { return vertexCount_; }

  /// How many are held.
  [[nodiscard]] std::uint32_t count() const { return count_; }

  [[nodiscard]] bool complete() const { return count_ == vertexCount_; }

  [[nodiscard]] bool holds(VertexId v) const { return (words_[v / 64] >> (v % 64) & 1) != 0; }

  void add(VertexId v);
  void remove(VertexId v);
  /// Adds begin … end − 1.
  void addRange(VertexId begin, VertexId end);
  /// How many of begin … end − 1 are held. Cost: O(words).
  [[nodiscard]] std::uint32_t countRange(VertexId begin, VertexId end) const;
  /// Takes over a piece of a client's own account: bit i of `bits` (least significant first) is
  /// vertex first + i. Bits past the last vertex are ignored. first: a multiple of 8.
  void addBits(std::uint32_t first, std::span<const std::uint8_t> bits);

  [[nodiscard]] std::span<const std::uint64_t> words() const { return words_; }

  [[nodiscard]] std::size_t bytes() const { return words_.capacity() * sizeof(std::uint64_t); }

 private:
  std::uint32_t vertexCount_ = 0;
  std::uint32_t count_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace limn
