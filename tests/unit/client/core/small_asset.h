// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/forest/build_forest.h"

#include "protocol/messages.h"

#include "shared/codec/split_codec.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/active_mesh.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace limn {

/// A small prepared model and the messages that carry it, made by the code that makes real assets.
struct SmallAsset {
  BuiltForest built;
  SplitModel splitModel;
  Sha256Digest id{};
  std::vector<std::uint8_t> info;
  std::vector<std::uint8_t> base;
  std::vector<std::vector<std::uint8_t>> blocks;
  std::vector<std::vector<std::uint8_t>> packets;  // every remaining split, in level order
  std::vector<std::uint8_t> seeds;                 // empty when there are none

  /// A Packet with just these splits, sorted.
  [[nodiscard]] std::vector<std::uint8_t> packet(std::uint32_t pose, std::span<const VertexId> ids)
      const;
  /// First vertex that does not travel in the base mesh or a level block.
  [[nodiscard]] VertexId firstPacketVertex() const;
};

/// tag: makes the asset's id. seams: as in buildForest(). Few base faces, so that there are many
/// splits.
[[nodiscard]] SmallAsset makeSmallAsset(
    const TriangleMesh& mesh,
    std::uint8_t tag = 1,
    std::span<const std::uint8_t> seams = {});

/// Whether `mesh` is exactly the prepared mesh of `asset`: same positions and attributes, same
/// oriented triangles, vertex ids taken for slots.
[[nodiscard]] bool isWhole(const SmallAsset& asset, const ActiveMesh& mesh);

}  // namespace limn
