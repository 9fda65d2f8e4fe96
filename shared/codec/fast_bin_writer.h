// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/bin_coder.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace limn {

/// Writes the bytes that BinWriter writes, several times faster: the bits of a number's length are
/// in contexts of their own, so they are coded together, eight lanes at a time and without a
/// branch, and the coder divides by multiplying. To be kept from stream to stream: its buffers stay
/// as large as the largest one needed.
class FastBinWriter {
 public:
  /// Starts a stream. table: as for BinWriter.
  void begin(std::span<const Probability> table);

  bool code(std::uint32_t context, bool bit) {
    makeRoom(1);
    return push(context, bit);
  }

  std::uint32_t codeRaw(std::uint32_t bits, std::uint32_t value) {
    makeRoom(1);
    return pushRaw(bits, value);
  }

  /// A number as split_syntax::codeNumber() codes it.
  std::uint32_t codeNumber(std::uint32_t context, std::uint32_t value) {
    const std::uint32_t length = static_cast<std::uint32_t>(std::bit_width(value + 1)) - 1;
    if (length > kFastLength) return codeLongNumber(context, value);
    makeRoom(kFastRoom);
    pushNumber(context, value, length);
    return value;
  }

  /// A signed number as split_syntax::codeSigned() codes it.
  std::int32_t codeSigned(std::uint32_t context, std::int32_t value);

  /// Bits in contexts first, first + 1, …: token >> 1 is the context, the lowest bit what is coded.
  void codeTokens(std::uint32_t first, std::span<const std::uint8_t> tokens) {
    makeRoom(tokens.size());
    for (const std::uint8_t token : tokens)
      push(first + (token >> 1), (token & 1) != 0);
  }

  /// Appends the stream to `bytes`.
  void finish(std::vector<std::uint8_t>& bytes);

  [[nodiscard]] std::size_t bytes() const {
    return (states_.capacity() + begins_.capacity() + sizes_.capacity()) * sizeof(std::uint16_t) +
           stream_.capacity();
  }

 private:
  static constexpr std::uint32_t kFastLength = 13;  // of a number that is coded without a loop
  static constexpr std::size_t kFastRoom = 24;      // symbols written for one, used or not
  // Eight probabilities of 16 bits.
  using Lanes = std::uint16_t __attribute__((vector_size(16)));

  void makeRoom(std::size_t symbols) {
    if (begins_.size() - count_ < symbols) grow(symbols);
  }

  void grow(std::size_t symbols);
  std::uint32_t codeLongNumber(std::uint32_t context, std::uint32_t value);

  // As AdaptiveBit: probabilities never come near 0 or 4096, so its clamp has nothing to do.
  bool push(std::uint32_t context, bool bit) {
    std::uint16_t& state = states_[context];
    const std::uint32_t zero = state >> 4;
    begins_[count_] = static_cast<std::uint16_t>(bit ? zero : 0);
    sizes_[count_++] = static_cast<std::uint16_t>(bit ? 4096 - zero : zero);
    const std::uint32_t down = state >> 6;
    const std::uint32_t up = (65535U - state) >> 6;
    state = static_cast<std::uint16_t>(bit ? state - down : state + up);
    return bit;
  }

  std::uint32_t pushRaw(std::uint32_t bits, std::uint32_t value) {
    begins_[count_] = static_cast<std::uint16_t>(value << (12 - bits));
    sizes_[count_++] = static_cast<std::uint16_t>(1 << (12 - bits));
    return value;
  }

  /// Lanes first … first + 7 of a length's unary bits: ones, then a zero in lane `length`.
  void pushUnary(std::uint32_t context, std::uint32_t first, std::uint32_t length) {
    // Windows of it: as many ones as wanted, then zeros.
    alignas(16) static constexpr std::uint16_t kMasks[24] =
        {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF};
    const std::uint32_t ones = length - first < 8 ? length - first : 8;
    Lanes one;
    Lanes live;
    Lanes state;
    std::memcpy(&one, kMasks + 8 - ones, sizeof(one));
    std::memcpy(&live, kMasks + 8 - (ones < 8 ? ones + 1 : 8), sizeof(live));
    std::memcpy(&state, &states_[context + first], sizeof(state));
    const Lanes zero = state >> 4;
    const Lanes begin = zero & one;
    const Lanes size = ((4096 - zero) & one) | (zero & ~one);
    const Lanes change = (-(state >> 6) & one) | ((~state >> 6) & ~one);
    const Lanes next = state + (change & live);
    std::memcpy(&states_[context + first], &next, sizeof(next));
    std::memcpy(&begins_[count_ + first], &begin, sizeof(begin));
    std::memcpy(&sizes_[count_ + first], &size, sizeof(size));
  }

  /// Room for kFastRoom is there; every symbol is written, and counted if it belongs.
  void pushNumber(std::uint32_t context, std::uint32_t value, std::uint32_t length) {
    pushUnary(context, 0, length);
    if (length >= 8) pushUnary(context, 8, length);
    count_ += length + 1;
    const std::size_t some = length > 0 ? 1 : 0;
    const std::size_t more = length > 1 ? 1 : 0;
    // The bit below the top; without one the context is nobody's.
    push(context + 16 + length, ((value + 1) << 1 >> length & 1) != 0);
    count_ -= 1 - some;
    const std::uint32_t rest = more != 0 ? length - 1 : 0;
    pushRaw(rest, (value + 1) & ((1U << rest) - 1));
    count_ -= 1 - more;
  }

  std::vector<std::uint16_t> states_;  // by context: probability of a zero, in 65,536ths
  // Symbols: parts of the unit interval, in 4096ths; begins_.size() of them fit.
  std::vector<std::uint16_t> begins_;
  std::vector<std::uint16_t> sizes_;
  std::size_t count_ = 0;
  std::vector<std::uint8_t> stream_;
};

}  // namespace limn
