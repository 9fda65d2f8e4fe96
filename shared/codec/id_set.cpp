// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/id_set.h"

#include "shared/codec/varint.h"

namespace limn {

std::vector<std::uint8_t> encodeIdSet(std::span<const VertexId> sortedIds) {
  std::vector<std::uint8_t> bytes;
  VertexId expected = 0;
  for (const VertexId id : sortedIds) {
    appendVarint(id - expected, bytes);
    expected = id + 1;
  }
  return bytes;
}

Result<std::vector<VertexId>> decodeIdSet(
    std::span<const std::uint8_t> bytes,
    std::uint32_t vertexCount) {
  std::vector<VertexId> ids;
  std::uint64_t expected = 0;
  VarintReader in(bytes);
  while (!in.atEnd()) {
    const auto gap = in.read();
    if (!gap || expected + *gap >= vertexCount)
      return fail(ErrorCode::kCorrupt, "id set is damaged");
    ids.push_back(static_cast<VertexId>(expected + *gap));
    expected += *gap + 1;
  }
  return ids;
}

}  // namespace limn
