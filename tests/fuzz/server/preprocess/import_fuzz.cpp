// SPDX-License-Identifier: Apache-2.0
// Any bytes: refused with a reason, or a mesh that repair makes a valid manifold of or refuses. The
// first byte chooses the extension, the rest is the file.
#include "server/preprocess/import/import.h"
#include "server/preprocess/repair/repair.h"

#include "shared/mesh/half_edge.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr std::string_view kExtensions[] = {".ply", ".obj", ".stl", ".off", ".glb", ".gltf"};
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto imported = limn::importMesh(bytes, kExtensions[data[0] % 6]);
  if (!imported) {
    if (imported.error().message.empty()) std::abort();
    return 0;
  }
  const auto repaired = limn::repairMesh(*imported, {.quantizationBits = 11});
  if (!repaired) {
    if (repaired.error().code == limn::ErrorCode::kNonManifold) std::abort();
    return 0;
  }
  const auto linked = limn::HalfEdgeMesh::build(
      static_cast<std::uint32_t>(repaired->mesh.positions.size()),
      repaired->mesh.triangles);
  if (!linked || !limn::validate(*linked)) std::abort();
  return 0;
}
