// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Probability of a context's zero, in 256ths, 1 to 255.
using Probability = std::uint8_t;

/// Three ends of the same syntax: whatever is coded is a sequence of bins, each a bit in a context.
/// A syntax function is written once against `bool code(context, bit)`, which returns the bit: a
/// BinWriter and a BinCounter take it, a BinReader ignores it and returns what it reads.

/// Collects bins, then writes them as one stream with Draco's binary rANS coder (rabs_desc_write).
class BinWriter {
 public:
  explicit BinWriter(std::span<const Probability> probabilities) : probabilities_(probabilities) {}

  bool code(std::uint32_t context, bool bit) {
    bins_.push_back(static_cast<std::uint16_t>(probabilities_[context] << 1 | (bit ? 1 : 0)));
    return bit;
  }

  /// Appends the stream to `bytes`. rANS writes backwards, so nothing comes out before.
  void finish(std::vector<std::uint8_t>& bytes) const;
  /// How many bits the bins hold, exactly: −Σ log2 p.
  [[nodiscard]] double entropyBits() const;

 private:
  std::span<const Probability> probabilities_;
  std::vector<std::uint16_t> bins_;  // probability << 1 | bit
};

/// Reads what BinWriter wrote. Total over any bytes: past the end it returns arbitrary bits.
class BinReader {
 public:
  BinReader(std::span<const Probability> probabilities, std::span<const std::uint8_t> bytes);

  bool code(std::uint32_t context, bool ignored = false);

  /// False when the bytes cannot be a stream.
  [[nodiscard]] bool isValid() const { return valid_; }

  /// True when every byte has been used and the coder is back at its start, as after a whole
  /// stream.
  [[nodiscard]] bool isFinished() const;

 private:
  std::span<const Probability> probabilities_;
  std::span<const std::uint8_t> bytes_;
  std::int32_t offset_ = 0;
  std::uint32_t state_ = 0;
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

  [[nodiscard]] std::vector<Probability> probabilities() const;

 private:
  std::vector<std::array<std::uint32_t, 2>> counts_;
};

}  // namespace limn
