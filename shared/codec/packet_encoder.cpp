// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/packet_encoder.h"

#include "shared/codec/varint.h"
#include "shared/core/assert.h"

#include <algorithm>

namespace limn {

PacketEncoder::PacketEncoder(const SplitForest& forest, const SplitModel& model)
    : forest_(forest),
      model_(model),
      symbols_(forest.splitCount()) {}

std::vector<std::uint8_t> PacketEncoder::encode(std::span<const VertexId> ids) {
  LIMN_ASSERT(std::is_sorted(ids.begin(), ids.end()));
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * ids.size() + 16);
  appendVarint(2 * ids.size(), bytes);
  bins_.begin(model_.probabilities);
  split_syntax::NameState names;
  const std::uint32_t base = forest_.baseVertexCount();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    // Splits of a packet lie all over the model.
    constexpr std::size_t kAhead = 8;
    if (i + 2 * kAhead < ids.size()) {
      symbols_.prefetchPlace(ids[i + 2 * kAhead] - base);
      __builtin_prefetch(&forest_.parents[ids[i + 2 * kAhead] - base]);
    }
    if (i + kAhead < ids.size()) symbols_.prefetch(ids[i + kAhead] - base);
    const VertexId v = ids[i];
    VertexId vertex = v;
    VertexId parent = forest_.parent(v);
    split_syntax::codeName(bins_, names, forest_.levelBegin, vertex, parent);
    const std::uint32_t split = v - base;
    const std::uint8_t* packed = symbols_.find(split);
    if (packed == nullptr) {
      split_.clear();
      modelSplit(forest_, model_, v, split_);
      packed_.clear();
      split_.pack(packed_);
      symbols_.add(split, packed_);
      packed = packed_.data();
    }
    SplitSymbols::replay(packed, bins_);
  }
  bins_.finish(bytes);
  return bytes;
}

}  // namespace limn
