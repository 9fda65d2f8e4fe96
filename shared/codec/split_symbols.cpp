// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/split_symbols.h"

#include "shared/core/assert.h"

#include <algorithm>

namespace limn {

bool SplitSymbols::code(std::uint32_t context, bool bit) {
  LIMN_ASSERT(context >= split_syntax::kOpenSide && context < split_syntax::kResidual);
  tokens_.push_back(
      static_cast<std::uint8_t>((context - split_syntax::kOpenSide) << 1 | (bit ? 1 : 0)));
  return bit;
}

std::int32_t SplitSymbols::codeSigned(std::uint32_t context, std::int32_t value) {
  LIMN_ASSERT(residuals_ < 3);
  scales_[residuals_] = static_cast<std::uint8_t>(
      (context - split_syntax::kResidual) / split_syntax::kNumberContexts / 2);
  values_[residuals_++] = value;
  return value;
}

void SplitSymbols::clear() {
  tokens_.clear();
  residuals_ = 0;
}

void SplitSymbols::pack(std::vector<std::uint8_t>& bytes) const {
  LIMN_ASSERT(residuals_ == 3 && tokens_.size() <= 0xFFFF);
  const bool isNarrow = std::ranges::all_of(values_, [](std::int32_t value) {
    return value >= -kNarrow && value < kNarrow;
  });
  const bool isShort = tokens_.size() < kCountMask;
  const std::size_t count = isShort ? tokens_.size() : kCountMask;
  bytes.push_back(static_cast<std::uint8_t>(count | (isNarrow ? 0 : kWide)));
  const auto append = [&bytes](const auto& value) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof(value));
  };
  if (!isShort) {
    bytes.push_back(static_cast<std::uint8_t>(tokens_.size() & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>(tokens_.size() >> 8));
  }
  bytes.insert(bytes.end(), tokens_.begin(), tokens_.end());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (isNarrow) {
      append(static_cast<std::uint16_t>(scales_[axis] << kNarrowBits | (values_[axis] + kNarrow)));
    } else {
      bytes.push_back(scales_[axis]);
      append(values_[axis]);
    }
  }
}

void SplitSymbolStore::add(std::uint32_t split, std::span<const std::uint8_t> packed) {
  LIMN_ASSERT(packed.size() <= kPage);
  if (places_[split] != 0) return;
  // What does not fit the last page begins the next.
  if (next_ % kPage + packed.size() > kPage) next_ = (next_ / kPage + 1) * kPage;
  const std::size_t page = next_ / kPage;
  if (page >= pages_.size()) pages_.push_back(std::make_unique<std::uint8_t[]>(kPage));
  std::ranges::copy(packed, pages_[page].get() + next_ % kPage);
  places_[split] = next_;
  next_ += static_cast<std::uint32_t>(packed.size());
}

}  // namespace limn
