// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Contexts that learn from nothing, fast at first, and go on from stream to stream: for data that
/// comes in order and is too short for tables (a hull's few hundred splits). What must decode by
/// itself uses bin_coder.h. protocol/SPEC.md, "Hull splits", fixes the arithmetic.
class AdaptiveContexts {
 public:
  /// Context 0 is an even bit and stays one.
  explicit AdaptiveContexts(std::size_t count);

  /// Of a zero, in 256ths, 1 to 255.
  [[nodiscard]] std::uint8_t zero(std::uint32_t context) const;
  void update(std::uint32_t context, bool bit);

 private:
  struct Context {
    std::uint16_t zero = 1U << 15;  // in 65536ths
    std::uint8_t age = 0;           // bits seen, up to where the rate stays
  };

  std::vector<Context> contexts_;
};

/// Collects bits in contexts, then writes them as one stream with Draco's binary rANS coder
/// (rabs_desc_write). `contexts` moves on with every bit and outlives this.
class AdaptiveBinWriter {
 public:
  explicit AdaptiveBinWriter(AdaptiveContexts& contexts) : contexts_(contexts) {}

  bool code(std::uint32_t context, bool bit);
  /// The stream. rANS writes backwards, so nothing comes out before.
  [[nodiscard]] std::vector<std::uint8_t> finish() const;

 private:
  AdaptiveContexts& contexts_;
  std::vector<std::uint16_t> bins_;  // probability << 1 | bit
};

/// Reads what AdaptiveBinWriter wrote, given contexts in the same state. Total over any bytes: past
/// the end it returns arbitrary bits.
class AdaptiveBinReader {
 public:
  AdaptiveBinReader(AdaptiveContexts& contexts, std::span<const std::uint8_t> bytes);

  bool code(std::uint32_t context, bool ignored = false);

  /// False when the bytes cannot be a stream.
  [[nodiscard]] bool isValid() const { return valid_; }

  /// True when every byte has been used and the coder is back at its start.
  [[nodiscard]] bool isFinished() const;

 private:
  AdaptiveContexts& contexts_;
  std::span<const std::uint8_t> bytes_;
  std::int32_t offset_ = 0;
  std::uint32_t state_ = 0;
  bool valid_ = false;
};

}  // namespace limn
