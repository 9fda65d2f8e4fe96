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
  for (const VertexId v : ids) {
    VertexId vertex = v;
    VertexId parent = forest_.parent(v);
    split_syntax::codeName(bins_, names, forest_.levelBegin, vertex, parent);
    const std::uint32_t split = v - forest_.baseVertexCount();
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
