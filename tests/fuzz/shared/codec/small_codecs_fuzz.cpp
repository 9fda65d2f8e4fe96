// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a split model, seeds, an id set or a contour: what decodes must encode to something
// that decodes to the same.
#include "shared/codec/contour_codec.h"
#include "shared/codec/id_set.h"
#include "shared/codec/seed_codec.h"
#include "shared/codec/split_codec.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  switch (data[0] % 4) {
    case 0: {
      const auto placement = static_cast<limn::Placement>(data[0] / 4 % 2);
      const auto model = limn::parseSplitModel(bytes, placement);
      if (model &&
          limn::parseSplitModel(limn::serializeSplitModel(*model), placement)->probabilities !=
              model->probabilities) {
        std::abort();
      }
      break;
    }
    case 1: {
      const auto seeds = limn::decodeSeeds(bytes, 1000);
      if (seeds && limn::decodeSeeds(limn::encodeSeeds(*seeds), 1000)->seeds != seeds->seeds)
        std::abort();
      break;
    }
    case 2: {
      const auto lines = limn::decodeContour(bytes, 1000);
      if (lines && *limn::decodeContour(limn::encodeContour(*lines), 1000) != *lines) std::abort();
      break;
    }
    default: {
      const auto ids = limn::decodeIdSet(bytes, 1000);
      if (ids && *limn::decodeIdSet(limn::encodeIdSet(*ids), 1000) != *ids) std::abort();
    }
  }
  return 0;
}
