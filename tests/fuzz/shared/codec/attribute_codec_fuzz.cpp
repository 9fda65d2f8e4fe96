// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a run of splits with attributes: the first byte says which attributes, the second
// where the runs end and the attributes begin.
#include "shared/codec/split_codec.h"
#include "shared/mesh/primitives.h"

#include <cstdlib>

namespace {

limn::ActiveMesh freshMesh(std::uint8_t kinds) {
  limn::TriangleMesh base = limn::primitives::icosphere(1);
  const auto vertices = static_cast<std::uint32_t>(base.positions.size());
  if ((kinds & limn::kAttributeColors) != 0) base.attributes.colors.assign(vertices, {200, 40, 10});
  if ((kinds & limn::kAttributeNormals) != 0) {
    base.attributes.normals.assign(vertices, limn::OctNormal(limn::kOctRadius));
  }
  return *limn::ActiveMesh::fromBase(
      {0, vertices, vertices + 12, vertices + 40, vertices + 100},
      base,
      {});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::uint8_t kinds = data[0] & 7;
  const std::span<const std::uint8_t> bytes(data + 2, size - 2);
  const std::size_t cut = bytes.size() * data[1] / 256;
  limn::ActiveMesh mesh = freshMesh(kinds);
  limn::SplitDecoder decoder(limn::defaultSplitModel(), kinds);
  static_cast<void>(decoder.decode(bytes.first(cut), mesh, bytes.subspan(cut)));
  if (!limn::validate(mesh.mesh())) std::abort();
  return 0;
}
