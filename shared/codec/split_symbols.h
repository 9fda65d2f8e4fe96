// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/split_syntax.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

namespace limn {

/// The symbols of one split, its name apart: what split_syntax.h codes for its cut, features,
/// position and parent's move, as numbers in contexts. They depend on nothing but the split.
class SplitSymbols {
 public:
  // An end of the split syntax (bin_coder.h) that keeps what it is given.
  bool code(std::uint32_t context, bool bit);

  std::uint32_t codeRaw(std::uint32_t, std::uint32_t value) { return value; }

  std::int32_t codeSigned(std::uint32_t context, std::int32_t value);

  void clear();
  /// About 10 bytes, appended.
  void pack(std::vector<std::uint8_t>& bytes) const;

  /// Gives packed symbols to an end of the syntax that takes tokens (FastBinWriter).
  template <class Bins>
  static void replay(const std::uint8_t* packed, Bins& bins) {
    std::size_t tokens = *packed & kCountMask;
    const bool mayMove = (*packed & kMayMove) != 0;
    const bool isWide = (*packed++ & kWide) != 0;
    if (tokens == kCountMask) {
      tokens = static_cast<std::size_t>(packed[0] | packed[1] << 8);
      packed += 2;
    }
    bins.codeTokens(split_syntax::kOpenSide, {packed, tokens});
    packed += tokens;
    packed = replayResiduals(packed, isWide, bins);
    if (!mayMove) return;
    const std::uint8_t moved = *packed++;
    bins.code(split_syntax::kMoved + (moved >> 1), (moved & 1) != 0);
    if ((moved & 1) != 0) replayResiduals(packed, isWide, bins);
  }

 private:
  template <class Bins>
  static const std::uint8_t* replayResiduals(const std::uint8_t* packed, bool isWide, Bins& bins) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      std::uint32_t scale = 0;
      std::int32_t residual = 0;
      if (!isWide) {
        std::uint16_t both = 0;
        std::memcpy(&both, packed, sizeof(both));
        packed += sizeof(both);
        scale = both >> kNarrowBits;
        residual = (both & ((1 << kNarrowBits) - 1)) - kNarrow;
      } else {
        scale = *packed++;
        std::memcpy(&residual, packed, sizeof(residual));
        packed += sizeof(residual);
      }
      const std::uint32_t context = 2 * scale + (axis == 2 ? 1 : 0);
      bins.codeSigned(split_syntax::kResidual + context * split_syntax::kNumberContexts, residual);
    }
    return packed;
  }

  // Packed: a byte with the number of tokens (all ones: two more bytes have it), whether residuals
  // are wide and whether the parent may move; tokens; three residuals with their scales, 2 bytes
  // each, 5 when wide; where the parent may move, a byte like a token of whether it does, and if so
  // three more residuals.
  static constexpr std::uint8_t kWide = 0x80;
  static constexpr std::uint8_t kMayMove = 0x40;
  static constexpr std::uint8_t kCountMask = 0x3F;
  static constexpr int kNarrowBits = 10;
  static constexpr std::int32_t kNarrow = 1 << (kNarrowBits - 1);
  static_assert(split_syntax::kScales <= 1U << (16 - kNarrowBits));
  static_assert(split_syntax::kResidual - split_syntax::kOpenSide <= 128);

  std::vector<std::uint8_t> tokens_;  // (context − kOpenSide) << 1 | bit
  std::uint32_t residuals_ = 0;       // how many have come
  std::uint8_t moved_ = 0;            // (context − kMoved) << 1 | bit
  bool mayMove_ = false;
  std::uint8_t scales_[6] = {};
  std::int32_t values_[6] = {};
};

/// Packed symbols of a forest's splits, as far as anybody has asked for them. Pages are never
/// moved. Not synchronised.
class SplitSymbolStore {
 public:
  explicit SplitSymbolStore(std::uint32_t splits) : places_(splits, 0) {}

  /// Null when they are not there yet. split: id less those of the base.
  [[nodiscard]] const std::uint8_t* find(std::uint32_t split) const {
    const std::uint32_t place = places_[split];
    return place == 0 ? nullptr : pages_[place / kPage].get() + place % kPage;
  }

  /// Asks the processor for what find() will read: the place first, then what is there.
  void prefetchPlace(std::uint32_t split) const { __builtin_prefetch(&places_[split]); }

  void prefetch(std::uint32_t split) const {
    if (const std::uint8_t* packed = find(split)) __builtin_prefetch(packed);
  }

  /// packed: of SplitSymbols::pack().
  void add(std::uint32_t split, std::span<const std::uint8_t> packed);

  [[nodiscard]] std::size_t bytes() const {
    return places_.capacity() * sizeof(places_[0]) + pages_.size() * kPage;
  }

 private:
  static constexpr std::uint32_t kPage = 1U << 16;

  std::vector<std::uint32_t> places_;  // 0: not there
  std::vector<std::unique_ptr<std::uint8_t[]>> pages_;
  std::uint32_t next_ = 1;
};

}  // namespace limn
