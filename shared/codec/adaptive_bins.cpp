// SPDX-License-Identifier: Apache-2.0
//
// Based on: J. Duda, "Asymmetric numeral systems", arXiv 1311.2540; the coder is Draco's.
#include "shared/codec/adaptive_bins.h"

#include <draco/compression/entropy/ans.h>

#include <algorithm>

namespace limn {
namespace {

/// A probability moves by 1/2 of the way at first, then 1/3, 1/4, …, and at last by this part.
constexpr int kSlowest = 48;
constexpr std::uint32_t kRaw = 0;
// The state that ans_write_init starts from (ans.h keeps its name to itself).
constexpr std::uint32_t kInitialState = 4096;

}  // namespace

AdaptiveContexts::AdaptiveContexts(std::size_t count) : contexts_(count) {}

std::uint8_t AdaptiveContexts::zero(std::uint32_t context) const {
  return static_cast<std::uint8_t>(std::clamp(contexts_[context].zero >> 8, 1, 255));
}

void AdaptiveContexts::update(std::uint32_t context, bool bit) {
  if (context == kRaw) return;
  Context& c = contexts_[context];
  const int target = bit ? 0 : 65535;
  c.zero = static_cast<std::uint16_t>(c.zero + (target - c.zero) / std::min(c.age + 2, kSlowest));
  if (c.age < kSlowest) ++c.age;
}

bool AdaptiveBinWriter::code(std::uint32_t context, bool bit) {
  bins_.push_back(static_cast<std::uint16_t>(contexts_.zero(context) << 1 | (bit ? 1 : 0)));
  contexts_.update(context, bit);
  return bit;
}

std::vector<std::uint8_t> AdaptiveBinWriter::finish() const {
  // A bin moves at most one byte out of the coder's state, and its end takes up to three.
  std::vector<std::uint8_t> bytes(bins_.size() + 4);
  draco::AnsCoder coder;
  draco::ans_write_init(&coder, bytes.data());
  for (auto bin = bins_.rbegin(); bin != bins_.rend(); ++bin)
    draco::rabs_desc_write(&coder, *bin & 1, static_cast<draco::AnsP8>(*bin >> 1));
  bytes.resize(static_cast<std::size_t>(draco::ans_write_end(&coder)));
  return bytes;
}

AdaptiveBinReader::AdaptiveBinReader(
    AdaptiveContexts& contexts,
    std::span<const std::uint8_t> bytes)
    : contexts_(contexts),
      bytes_(bytes) {
  draco::AnsDecoder decoder;
  valid_ = !bytes.empty() &&
           draco::ans_read_init(&decoder, bytes.data(), static_cast<int>(bytes.size())) == 0;
  if (!valid_) return;
  offset_ = decoder.buf_offset;
  state_ = decoder.state;
}

bool AdaptiveBinReader::code(std::uint32_t context, bool) {
  draco::AnsDecoder decoder;
  decoder.buf = bytes_.data();
  decoder.buf_offset = offset_;
  decoder.state = state_;
  const bool bit = draco::rabs_desc_read(&decoder, contexts_.zero(context)) != 0;
  offset_ = decoder.buf_offset;
  state_ = decoder.state;
  contexts_.update(context, bit);
  return bit;
}

bool AdaptiveBinReader::isFinished() const {
  if (!valid_) return false;
  if (offset_ == 0) return state_ == kInitialState;
  // Draco refills the state before a bin, not after: when the last bin was the least likely one,
  // the byte that the writer moved out before anything else is still there.
  return offset_ == 1 && state_ * 256 + bytes_[0] == kInitialState;
}

}  // namespace limn
