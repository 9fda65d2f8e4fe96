// SPDX-License-Identifier: Apache-2.0
#include "server/session/have_set.h"

#include "shared/core/assert.h"

#include <algorithm>
#include <bit>

namespace limn {

HaveSet::HaveSet(std::uint32_t vertexCount)
    : vertexCount_(vertexCount),
      words_((std::size_t{vertexCount} + 63) / 64, 0) {}

void HaveSet::add(VertexId v) {
  LIMN_ASSERT(v < vertexCount_);
  const std::uint64_t bit = std::uint64_t{1} << (v % 64);
  count_ += (words_[v / 64] & bit) == 0 ? 1 : 0;
  words_[v / 64] |= bit;
}

void HaveSet::remove(VertexId v) {
  LIMN_ASSERT(v < vertexCount_);
  const std::uint64_t bit = std::uint64_t{1} << (v % 64);
  count_ -= (words_[v / 64] & bit) != 0 ? 1 : 0;
  words_[v / 64] &= ~bit;
}

void HaveSet::addRange(VertexId begin, VertexId end) {
  for (VertexId v = begin; v < end; ++v)
    add(v);
}

std::uint32_t HaveSet::countRange(VertexId begin, VertexId end) const {
  LIMN_ASSERT(begin <= end && end <= vertexCount_);
  std::uint32_t count = 0;
  while (begin < end) {
    const std::uint32_t offset = begin % 64;
    const std::uint32_t length = std::min(64 - offset, end - begin);
    const std::uint64_t mask = length == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << length) - 1;
    count += static_cast<std::uint32_t>(std::popcount(words_[begin / 64] >> offset & mask));
    begin += length;
  }
  return count;
}

void HaveSet::addBits(std::uint32_t first, std::span<const std::uint8_t> bits) {
  LIMN_ASSERT(first % 8 == 0);
  for (std::size_t i = 0; i < bits.size(); ++i) {
    const std::uint64_t start = std::uint64_t{first} + 8 * i;
    if (start >= vertexCount_) return;
    std::uint64_t byte = bits[i];
    const std::uint64_t left = vertexCount_ - start;
    if (left < 8) byte &= (std::uint64_t{1} << left) - 1;
    std::uint64_t& word = words_[start / 64];
    const std::uint64_t added = (byte << (start % 64)) & ~word;
    count_ += static_cast<std::uint32_t>(std::popcount(added));
    word |= added;
  }
}

}  // namespace limn
