// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as pieces of a hull's splits (the first byte says where the first piece ends), against
// a small base mesh: an error or a valid mesh. And any bytes as a base.
#include "shared/codec/draco_codec.h"
#include "shared/codec/hull_codec.h"
#include "shared/mesh/primitives.h"

#include <algorithm>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const limn::TriangleMesh kBase = limn::primitives::icosphere(1);
  static const std::vector<std::uint8_t> kBytes = limn::encodeDraco(kBase)->bytes;
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  static_cast<void>(limn::HullDecoder::begin(bytes, kBase.grid, 1000));
  auto decoder = limn::HullDecoder::begin(kBytes, kBase.grid, 1000);
  if (!decoder) std::abort();
  const std::size_t cut = std::min<std::size_t>(data[0], bytes.size());
  if (decoder->addPiece(bytes.first(cut), 1000))
    static_cast<void>(decoder->addPiece(bytes.subspan(cut), 1000));
  const limn::ProgressiveHull& hull = decoder->hull();
  const auto mesh = limn::hullAfter(hull, hull.splits.size());
  if (!mesh || !limn::HullRefiner::fromBase(*mesh)) std::abort();
  return 0;
}
