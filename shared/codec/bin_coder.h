// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Probability of a context's zero at the start of a stream, in 256ths, 1 to 255.
using Probability = std::uint8_t;

/// A context's state while a stream runs: the probability of a zero, in 65,536ths. It starts from
/// the model's table and follows what is coded, so a stream fits its splits, and needs nothing but
/// the table to be read.
class AdaptiveBit {
 public:
  AdaptiveBit() = default;

  explicit AdaptiveBit(Probability zero) : zero_(static_cast<std::uint16_t>(zero << 8)) {}

  /// In 4096ths, 1 to 4095.
  [[nodiscard]] std::uint32_t zero() const { return zero_ >> 4 < 1 ? 1U : zero_ >> 4; }

  void update(bool bit) {
    if (bit) {
      zero_ = static_cast<std::uint16_t>(zero_ - (zero_ >> kRate));
    } else {
      zero_ = static_cast<std::uint16_t>(zero_ + ((65535 - zero_) >> kRate));
    }
  }

 private:
  static constexpr int kRate = 6;
  std::uint16_t zero_ = 1 << 15;
};

/// Three ends of the same syntax: whatever is coded is a sequence of bits in contexts and of raw
/// bits. A syntax function is written once against
///   bool code(context, bit)            an adaptive bit,
///   std::uint32_t codeRaw(bits, value) `bits` ≤ 12 even bits,
/// which return what is coded: a BinWriter and a BinCounter take it, a BinReader ignores it and
/// returns what it reads.

/// Collects symbols, then writes them as one stream with Draco's rANS coder of 12 bits' precision.
class BinWriter {
 public:
  explicit BinWriter(std::span<const Probability> table) : states_(table.begin(), table.end()) {}

  bool code(std::uint32_t context, bool bit) {
    AdaptiveBit& state = states_[context];
    const std::uint32_t zero = state.zero();
    if (bit) {
      symbols_.push_back(
          {static_cast<std::uint16_t>(zero), static_cast<std::uint16_t>(4096 - zero)});
    } else {
      symbols_.push_back({0, static_cast<std::uint16_t>(zero)});
    }
    state.update(bit);
    return bit;
  }

  std::uint32_t codeRaw(std::uint32_t bits, std::uint32_t value) {
    symbols_.push_back(
        {static_cast<std::uint16_t>(value << (12 - bits)),
         static_cast<std::uint16_t>(1 << (12 - bits))});
    return value;
  }

  /// Appends the stream to `bytes`. rANS writes backwards, so nothing comes out before.
  void finish(std::vector<std::uint8_t>& bytes) const;

 private:
  // A part of the unit interval, in 4096ths.
  struct Symbol {
    std::uint16_t begin;
    std::uint16_t size;
  };

  std::vector<AdaptiveBit> states_;
  std::vector<Symbol> symbols_;
};

/// Reads what BinWriter wrote. Total over any bytes: past the end it returns arbitrary bits.
class BinReader {
 public:
  BinReader(std::span<const Probability> table, std::span<const std::uint8_t> bytes);

  bool code(std::uint32_t context, bool ignored = false) {
    static_cast<void>(ignored);
    AdaptiveBit& state = states_[context];
    const std::uint32_t zero = state.zero();
    const std::uint32_t rest = state_ & 4095;
    const bool bit = rest >= zero;
    state_ = bit ? (state_ >> 12) * (4096 - zero) + rest - zero : (state_ >> 12) * zero + rest;
    state.update(bit);
    refill();
    return bit;
  }

  std::uint32_t codeRaw(std::uint32_t bits, std::uint32_t ignored = 0) {
    static_cast<void>(ignored);
    const std::uint32_t low = 12 - bits;
    const std::uint32_t rest = state_ & 4095;
    state_ = ((state_ >> 12) << low) + (rest & ((1U << low) - 1));
    refill();
    return rest >> low;
  }

  /// False when the bytes cannot be a stream.
  [[nodiscard]] bool isValid() const { return valid_; }

  /// True when every byte has been used and the coder is back at its start, as after a whole
  /// stream.
  [[nodiscard]] bool isFinished() const { return valid_ && left_ == 0 && state_ == kLow; }

 private:
  static constexpr std::uint32_t kLow = 4 * 4096;  // Draco's l_rans_base

  void refill() {
    while (state_ < kLow && left_ > 0)
      state_ = state_ << 8 | bytes_[--left_];
  }

  std::vector<AdaptiveBit> states_;
  std::span<const std::uint8_t> bytes_;
  std::size_t left_ = 0;  // bytes not yet read; they are read from the end
  std::uint32_t state_ = kLow;
  bool valid_ = false;
};

/// Counts bits by context, to measure probabilities.
class BinCounter {
 public:
  explicit BinCounter(std::size_t contexts) : counts_(contexts) {}

  bool code(std::uint32_t context, bool bit) {
    ++counts_[context][bit ? 1 : 0];
    return bit;
  }

  std::uint32_t codeRaw(std::uint32_t bits, std::uint32_t value) {
    static_cast<void>(bits);
    return value;
  }

  /// How many zeros and ones came in each context.
  [[nodiscard]] std::span<const std::array<std::uint32_t, 2>> counts() const { return counts_; }

 private:
  std::vector<std::array<std::uint32_t, 2>> counts_;
};

}  // namespace limn
