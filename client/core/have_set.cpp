// SPDX-License-Identifier: Apache-2.0
#include "client/core/have_set.h"

#include <algorithm>

namespace limn {

std::vector<std::vector<std::uint8_t>>
encodeHaveSet(const StreamDecoder& decoder, std::uint8_t channel, std::size_t pieceBytes) {
  std::vector<std::uint8_t> bits;
  if (decoder.hasBase()) {
    for (const VertexId v : decoder.mesh().ids()) {
      if (v / 8 >= bits.size()) bits.resize(v / 8 + 1, 0);
      bits[v / 8] = static_cast<std::uint8_t>(bits[v / 8] | (1U << (v % 8)));
    }
  }
  std::vector<std::vector<std::uint8_t>> pieces;
  std::size_t done = 0;
  do {
    const std::size_t size = std::min(pieceBytes, bits.size() - done);
    protocol::HaveSet piece;
    piece.channel = channel;
    piece.asset = decoder.model().asset;
    piece.base = decoder.hasBase();
    piece.seeds = decoder.seedBytesHeld();
    piece.first = static_cast<std::uint32_t>(8 * done);
    piece.bits = protocol::Bytes(bits).subspan(done, size);
    done += size;
    piece.last = done == bits.size();
    pieces.push_back(protocol::encodeMessage(piece));
  } while (done < bits.size());
  return pieces;
}

}  // namespace limn
