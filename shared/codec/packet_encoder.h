// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/codec/fast_bin_writer.h"
#include "shared/codec/split_codec.h"
#include "shared/codec/split_symbols.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Codes runs of any splits of one model, byte for byte as encodeSplits() does, for who codes the
/// same splits again and again: symbols do not depend on what else is sent, so each split is
/// modelled once, and from then on only coded. Memory: about 15 bytes for each split that was ever
/// asked for and 4 for each other. Not synchronised.
class PacketEncoder {
 public:
  /// Both outlive this.
  PacketEncoder(const SplitForest& forest, const SplitModel& model);

  /// encodeSplits(forest, model, ids). Cost: about a tenth of that for splits modelled before.
  [[nodiscard]] std::vector<std::uint8_t> encode(std::span<const VertexId> ids);

  [[nodiscard]] std::size_t bytes() const { return symbols_.bytes() + bins_.bytes(); }

 private:
  const SplitForest& forest_;
  const SplitModel& model_;
  SplitSymbolStore symbols_;
  FastBinWriter bins_;
  // Scratch.
  SplitSymbols split_;
  std::vector<std::uint8_t> packed_;
};

}  // namespace limn
