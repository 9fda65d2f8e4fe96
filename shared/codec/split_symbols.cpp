// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/split_symbols.h"

#include "shared/core/assert.h"

#include <algorithm>

namespace limn {

bool SplitSymbols::code(std::uint32_t context, bool bit) {
  if (context >= split_syntax::kMoved) {
    mayMove_ = true;
    moved_ = static_cast<std::uint8_t>((context - split_syntax::kMoved) << 1 | (bit ? 1 : 0));
    return bit;
  }
  LIMN_ASSERT(context >= split_syntax::kOpenSide && context < split_syntax::kResidual);
  tokens_.push_back(
      static_cast<std::uint8_t>((context - split_syntax::kOpenSide) << 1 | (bit ? 1 : 0)));
  return bit;
}

std::int32_t SplitSymbols::codeSigned(std::uint32_t context, std::int32_t value) {
  LIMN_ASSERT(residuals_ < 6);
  scales_[residuals_] = static_cast<std::uint8_t>(
      (context - split_syntax::kResidual) / split_syntax::kNumberContexts / 2);
  values_[residuals_++] = value;
  return value;
}

void SplitSymbols::clear() {
  tokens_.clear();
  residuals_ = 0;
  mayMove_ = false;
}

void SplitSymbols::pack(std::vector<std::uint8_t>& bytes) const {
  LIMN_ASSERT((residuals_ == 3 || residuals_ == 6) && tokens_.size() <= 0xFFFF);
  const bool isNarrow = std::all_of(values_, values_ + residuals_, [](std::int32_t value) {
    return value >= -kNarrow && value < kNarrow;
  });
  const bool isShort = tokens_.size() < kCountMask;
  const std::size_t count = isShort ? tokens_.size() : kCountMask;
  bytes.push_back(
      static_cast<std::uint8_t>(count | (isNarrow ? 0 : kWide) | (mayMove_ ? kMayMove : 0)));
  const auto append = [&bytes](const auto& value) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof(value));
  };
  if (!isShort) {
    bytes.push_back(static_cast<std::uint8_t>(tokens_.size() & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>(tokens_.size() >> 8));
  }
  bytes.insert(bytes.end(), tokens_.begin(), tokens_.end());
  for (std::size_t i = 0; i < residuals_; ++i) {
    if (i == 3) bytes.push_back(moved_);
    if (isNarrow) {
      append(static_cast<std::uint16_t>(scales_[i] << kNarrowBits | (values_[i] + kNarrow)));
    } else {
      bytes.push_back(scales_[i]);
      append(values_[i]);
    }
  }
  if (mayMove_ && residuals_ == 3) bytes.push_back(moved_);
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
