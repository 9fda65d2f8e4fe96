// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a run of splits, against a small base mesh and an even split model: an error or a
// valid mesh. The base is rich enough for runs to get somewhere: 80 faces, room for three levels.
#include "shared/codec/split_codec.h"
#include "shared/mesh/primitives.h"

#include <cstdlib>

namespace {

limn::ActiveMesh freshMesh() {
  static const limn::TriangleMesh kBase = limn::primitives::icosphere(1);
  const auto vertices = static_cast<std::uint32_t>(kBase.positions.size());
  return *limn::ActiveMesh::fromBase(
      {0, vertices, vertices + 12, vertices + 40, vertices + 100},
      kBase,
      {});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const auto placement : {limn::Placement::kSubset, limn::Placement::kVolume}) {
    limn::ActiveMesh mesh = freshMesh();
    limn::SplitModel model = limn::defaultSplitModel();
    model.placement = placement;
    const auto count = limn::SplitDecoder(model).decode({data, size}, mesh);
    if (count && mesh.splitsHeld() != *count) std::abort();
    if (!limn::validate(mesh.mesh())) std::abort();
  }
  return 0;
}
