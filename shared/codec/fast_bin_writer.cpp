// SPDX-License-Identifier: Apache-2.0
//
// Based on: J. Duda, "Asymmetric numeral systems", arXiv 1311.2540; the bytes are those of Draco's
// RAnsEncoder<12> (bin_coder.cpp), which the tests compare with. T. Granlund, P. Montgomery,
// "Division by invariant integers using multiplication", PLDI 1994.
#include "shared/codec/fast_bin_writer.h"

#include "shared/codec/split_syntax.h"

#include <algorithm>
#include <array>

namespace limn {
namespace {

constexpr std::uint32_t kInitialState = 4 * 4096;  // Draco's l_rans_base
constexpr std::uint32_t kLeastInverse = 5;         // sizes whose inverse fits 32 bits
constexpr int kInverseShift = 34;

/// ⌈2^34 / size⌉. The state is below 2^22, so state · inverse / 2^34 is less than 2^−12 above
/// state / size, which is not enough to reach the next whole number.
constexpr std::array<std::uint32_t, 4097> makeInverses() {
  std::array<std::uint32_t, 4097> inverses{};
  for (std::uint64_t size = kLeastInverse; size < inverses.size(); ++size) {
    inverses[size] =
        static_cast<std::uint32_t>(((std::uint64_t{1} << kInverseShift) + size - 1) / size);
  }
  return inverses;
}

constexpr std::array<std::uint32_t, 4097> kInverses = makeInverses();

}  // namespace

void FastBinWriter::begin(std::span<const Probability> table) {
  states_.resize(table.size());
  for (std::size_t i = 0; i < table.size(); ++i)
    states_[i] = static_cast<std::uint16_t>(table[i] << 8);
  count_ = 0;
}

void FastBinWriter::grow(std::size_t symbols) {
  const std::size_t size = std::max(2 * begins_.size(), count_ + symbols + 4096);
  begins_.resize(size);
  sizes_.resize(size);
}

std::uint32_t FastBinWriter::codeLongNumber(std::uint32_t context, std::uint32_t value) {
  // Without the functions that would lead back here.
  struct Plain {
    FastBinWriter& writer;

    bool code(std::uint32_t c, bool bit) { return writer.code(c, bit); }

    std::uint32_t codeRaw(std::uint32_t bits, std::uint32_t v) { return writer.codeRaw(bits, v); }
  };

  Plain plain{*this};
  return split_syntax::codeNumber(plain, context, value);
}

void FastBinWriter::finish(std::vector<std::uint8_t>& bytes) {
  // A symbol moves at most two bytes out of the coder's state, and its end takes up to three.
  stream_.resize(std::max(stream_.size(), 2 * count_ + 4));
  std::uint8_t* out = stream_.data();
  const std::uint16_t* const begins = begins_.data();
  const std::uint16_t* const sizes = sizes_.data();
  std::uint32_t state = kInitialState;
  for (std::size_t i = count_; i-- > 0;) {
    const std::uint32_t size = sizes[i];
    while (state >= size << 10) {
      *out++ = static_cast<std::uint8_t>(state);
      state >>= 8;
    }
    const std::uint32_t quotient =
        size >= kLeastInverse
            ? static_cast<std::uint32_t>(std::uint64_t{state} * kInverses[size] >> kInverseShift)
            : state / size;
    state += begins[i] + quotient * (4096 - size);
  }
  // How many bytes the state takes stands in the last one's two top bits.
  state -= kInitialState;
  const std::uint32_t more = state < 1U << 6 ? 0 : state < 1U << 14 ? 1 : 2;
  state |= more << (6 + 8 * more);
  for (std::uint32_t k = 0; k <= more; ++k)
    *out++ = static_cast<std::uint8_t>(state >> 8 * k);
  bytes.insert(bytes.end(), stream_.data(), out);
  count_ = 0;
}

}  // namespace limn
