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
    Symbols out = room(1);
    push(states_.data() + context, bit, out);
    count_ = out.count;
    return bit;
  }

  std::uint32_t codeRaw(std::uint32_t bits, std::uint32_t value) {
    Symbols out = room(1);
    pushRaw(bits, value, out);
    count_ = out.count;
    return value;
  }

  /// A number as split_syntax::codeNumber() codes it.
  std::uint32_t codeNumber(std::uint32_t context, std::uint32_t value) {
    const std::uint32_t length = static_cast<std::uint32_t>(std::bit_width(value + 1)) - 1;
    if (length > kFastLength) return codeLongNumber(context, value);
    Symbols out = room(kFastRoom);
    pushNumber(states_.data() + context, value, length, out);
    count_ = out.count;
    return value;
  }

  /// A signed number as split_syntax::codeSigned() codes it.
  std::int32_t codeSigned(std::uint32_t context, std::int32_t value) {
    const auto magnitude = static_cast<std::uint32_t>(value < 0 ? -value : value);
    const std::uint32_t length = static_cast<std::uint32_t>(std::bit_width(magnitude + 1)) - 1;
    if (length > kFastLength) {
      codeLongNumber(context, magnitude);
      codeRaw(1, value < 0 ? 1 : 0);
      return value;
    }
    Symbols out = room(kFastRoom);
    pushNumber(states_.data() + context, magnitude, length, out);
    pushRaw(1, value < 0 ? 1 : 0, out);
    count_ = out.count - (length > 0 ? 0 : 1);
    return value;
  }

  /// Bits in contexts first, first + 1, …: token >> 1 is the context, the lowest bit what is coded.
  void codeTokens(std::uint32_t first, std::span<const std::uint8_t> tokens) {
    Symbols out = room(tokens.size());
    std::uint16_t* const states = states_.data() + first;
    for (const std::uint8_t token : tokens)
      push(states + (token >> 1), (token & 1) != 0, out);
    count_ = out.count;
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

  /// Where symbols go; apart from the members, which a store of bytes could change for all that
  /// the compiler knows.
  struct Symbols {
    std::uint16_t* begins;
    std::uint16_t* sizes;
    std::size_t count;
  };

  Symbols room(std::size_t symbols) {
    if (begins_.size() - count_ < symbols) grow(symbols);
    return {begins_.data(), sizes_.data(), count_};
  }

  void grow(std::size_t symbols);
  std::uint32_t codeLongNumber(std::uint32_t context, std::uint32_t value);

  // As AdaptiveBit: probabilities never come near 0 or 4096, so its clamp has nothing to do.
  static void push(std::uint16_t* state, bool bit, Symbols& out) {
    const std::uint32_t before = *state;
    const std::uint32_t zero = before >> 4;
    out.begins[out.count] = static_cast<std::uint16_t>(bit ? zero : 0);
    out.sizes[out.count++] = static_cast<std::uint16_t>(bit ? 4096 - zero : zero);
    const std::uint32_t down = before >> 6;
    const std::uint32_t up = (65535U - before) >> 6;
    *state = static_cast<std::uint16_t>(bit ? before - down : before + up);
  }

  static void pushRaw(std::uint32_t bits, std::uint32_t value, Symbols& out) {
    out.begins[out.count] = static_cast<std::uint16_t>(value << (12 - bits));
    out.sizes[out.count++] = static_cast<std::uint16_t>(1 << (12 - bits));
  }

  /// Bits first … first + 7 of a length in unary: ones, then a zero as bit `length`.
  static void
  pushUnary(std::uint16_t* states, std::uint32_t first, std::uint32_t length, const Symbols& out) {
    // Windows of it: as many ones as wanted, then zeros.
    alignas(16) static constexpr std::uint16_t kMasks[24] =
        {0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF};
    const std::uint32_t ones = length - first < 8 ? length - first : 8;
    Lanes one;
    Lanes live;
    Lanes state;
    std::memcpy(&one, kMasks + 8 - ones, sizeof(one));
    std::memcpy(&live, kMasks + 8 - (ones < 8 ? ones + 1 : 8), sizeof(live));
    std::memcpy(&state, states + first, sizeof(state));
    const Lanes zero = state >> 4;
    const Lanes begin = zero & one;
    const Lanes size = ((4096 - zero) & one) | (zero & ~one);
    const Lanes change = (-(state >> 6) & one) | ((~state >> 6) & ~one);
    const Lanes next = state + (change & live);
    std::memcpy(states + first, &next, sizeof(next));
    std::memcpy(out.begins + out.count + first, &begin, sizeof(begin));
    std::memcpy(out.sizes + out.count + first, &size, sizeof(size));
  }

  /// length: at most kFastLength, with room for kFastRoom. Every symbol is written, and counted if
  /// it belongs.
  static void
  pushNumber(std::uint16_t* states, std::uint32_t value, std::uint32_t length, Symbols& out) {
    pushUnary(states, 0, length, out);
    if (length >= 8) pushUnary(states, 8, length, out);
    out.count += length + 1;
    // The bit below the top; without one the context is nobody's.
    push(states + 16 + length, ((value + 1) << 1 >> length & 1) != 0, out);
    out.count -= length > 0 ? 0 : 1;
    const std::uint32_t rest = length > 1 ? length - 1 : 0;
    pushRaw(rest, (value + 1) & ((1U << rest) - 1), out);
    out.count -= length > 1 ? 0 : 1;
  }

  std::vector<std::uint16_t> states_;  // by context: probability of a zero, in 65,536ths
  // Symbols: parts of the unit interval, in 4096ths; begins_.size() of them fit.
  std::vector<std::uint16_t> begins_;
  std::vector<std::uint16_t> sizes_;
  std::size_t count_ = 0;
  std::vector<std::uint8_t> stream_;
};

}  // namespace limn
