// SPDX-License-Identifier: Apache-2.0
//
// Based on: J. Duda, "Asymmetric numeral systems", arXiv 1311.2540; the coder is Draco's.
#include "shared/codec/bin_coder.h"

#include <draco/compression/entropy/ans.h>

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

// The state that ans_write_init starts from (ans.h keeps its name to itself).
constexpr std::uint32_t kInitialState = 4096;

}  // namespace

void BinWriter::finish(std::vector<std::uint8_t>& bytes) const {
  // A bin moves at most one byte out of the coder's state, and its end takes up to three.
  const std::size_t begin = bytes.size();
  bytes.resize(begin + bins_.size() + 4);
  draco::AnsCoder coder;
  draco::ans_write_init(&coder, bytes.data() + begin);
  for (auto bin = bins_.rbegin(); bin != bins_.rend(); ++bin) {
    draco::rabs_desc_write(&coder, *bin & 1, static_cast<draco::AnsP8>(*bin >> 1));
  }
  bytes.resize(begin + static_cast<std::size_t>(draco::ans_write_end(&coder)));
}

double BinWriter::entropyBits() const {
  double bits = 0.0;
  for (const std::uint16_t bin : bins_) {
    const int zero = bin >> 1;
    bits -= std::log2(((bin & 1) != 0 ? 256 - zero : zero) / 256.0);
  }
  return bits;
}

BinReader::BinReader(
    std::span<const Probability> probabilities,
    std::span<const std::uint8_t> bytes)
    : probabilities_(probabilities),
      bytes_(bytes) {
  draco::AnsDecoder decoder;
  valid_ = !bytes.empty() &&
           draco::ans_read_init(&decoder, bytes.data(), static_cast<int>(bytes.size())) == 0;
  if (!valid_) return;
  offset_ = decoder.buf_offset;
  state_ = decoder.state;
}

bool BinReader::code(std::uint32_t context, bool) {
  draco::AnsDecoder decoder;
  decoder.buf = bytes_.data();
  decoder.buf_offset = offset_;
  decoder.state = state_;
  const bool bit = draco::rabs_desc_read(&decoder, probabilities_[context]) != 0;
  offset_ = decoder.buf_offset;
  state_ = decoder.state;
  return bit;
}

bool BinReader::isFinished() const {
  if (!valid_) return false;
  if (offset_ == 0) return state_ == kInitialState;
  // Draco refills the state before a bin, not after: when the last bin was the least likely one,
  // the byte that the writer moved out before anything else is still there.
  return offset_ == 1 && state_ * 256 + bytes_[0] == kInitialState;
}

std::vector<Probability> BinCounter::probabilities() const {
  std::vector<Probability> result;
  result.reserve(counts_.size());
  for (const auto& [zeros, ones] : counts_) {
    // One of each is assumed seen: a bit that never came on this model can still be coded.
    const double share = (zeros + 0.4) / (static_cast<double>(zeros) + ones + 0.8);
    result.push_back(static_cast<Probability>(std::clamp(std::lround(256.0 * share), 1L, 255L)));
  }
  return result;
}

}  // namespace limn
