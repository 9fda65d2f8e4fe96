// SPDX-License-Identifier: Apache-2.0
//
// Based on: J. Duda, "Asymmetric numeral systems", arXiv 1311.2540; the coder is Draco's
// RAnsEncoder<12>, and the reader undoes what it does, a symbol at a time and without its tables.
#include "shared/codec/bin_coder.h"

#include <draco/compression/entropy/ans.h>

namespace limn {

void BinWriter::finish(std::vector<std::uint8_t>& bytes) const {
  // A symbol moves at most two bytes out of the coder's state, and its end takes up to four.
  const std::size_t begin = bytes.size();
  bytes.resize(begin + 2 * symbols_.size() + 4);
  draco::RAnsEncoder<12> coder;
  coder.write_init(bytes.data() + begin);
  for (auto symbol = symbols_.rbegin(); symbol != symbols_.rend(); ++symbol) {
    const draco::rans_sym sym{symbol->size, symbol->begin};
    coder.rans_write(&sym);
  }
  bytes.resize(begin + static_cast<std::size_t>(coder.write_end()));
}

BinReader::BinReader(std::span<const Probability> table, std::span<const std::uint8_t> bytes)
    : states_(table.begin(), table.end()),
      bytes_(bytes) {
  // The last byte's two top bits say how many more bytes the state takes.
  if (bytes.empty()) return;
  const std::size_t length = (bytes.back() >> 6) + 1U;
  if (length > bytes.size()) return;
  std::uint32_t state = bytes.back() & 0x3FU;
  for (std::size_t i = 2; i <= length; ++i)
    state = state << 8 | bytes[bytes.size() - i];
  if (state >= kLow * 255) return;
  state_ = state + kLow;
  left_ = bytes.size() - length;
  valid_ = true;
}

}  // namespace limn
