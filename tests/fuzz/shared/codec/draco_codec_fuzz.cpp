// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a Draco mesh, behind the header that lets them in: an error, or a mesh whose corners
// are vertices. Draco itself runs only on what the guard has passed.
#include "shared/codec/draco_codec.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto mesh = limn::decodeDraco({data, size}, 1U << 20, 1U << 20);
  if (!mesh) {
    if (mesh.error().message.empty()) std::abort();
    return 0;
  }
  for (const glm::uvec3& face : mesh->triangles) {
    for (int k = 0; k < 3; ++k)
      if (face[k] >= mesh->positions.size()) std::abort();
  }
  return 0;
}
