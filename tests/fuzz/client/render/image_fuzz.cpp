// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as the PNG of a map from a server.
#include "client/render/image_io.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto image = limn::decodePng({data, size}, {64, 64, 3});
  if (image && image->rgba.size() != 64U * 64 * 4) std::abort();
  return 0;
}
