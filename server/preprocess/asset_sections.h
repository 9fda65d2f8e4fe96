// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/forest/build_forest.h"

#include "protocol/messages.h"

#include "shared/core/sha256.h"
#include "shared/silhouette/seed_table.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace limn {

/// The wire sections of an asset: protocol messages, framed (protocol/framing.h), for channel 0.
struct WireSections {
  std::vector<std::uint8_t> info;
  std::vector<std::uint8_t> base;
  std::vector<std::uint8_t> blocks;
  std::vector<std::uint8_t> packets;
  std::vector<std::uint8_t> seeds;
  std::vector<std::uint64_t> levelBytes;  // on the wire, level 0 first
  std::uint64_t featureBytes = 0;         // of the base message: Base.features
  // Colours, normals and seams: how much longer the messages are for them.
  std::uint64_t baseAttributeBytes = 0;
  std::uint64_t blockAttributeBytes = 0;
  std::uint64_t packetAttributeBytes = 0;
};

/// The parts of ModelInfo that no mesh has. A model's name is none of them: names belong to the
/// store, assets to their content.
struct AssetIdentity {
  Sha256Digest id{};
  bool closed = false;
  std::optional<protocol::HullInfo> hull{};
  std::optional<protocol::MapInfo> maps{};
};

/// Encodes everything a client can be sent. Levels of the first 400 vertices (a tenth of them at
/// most), or of up to 1,300 where that is an eightieth, become level blocks. Cost: about 1 µs a
/// split.
[[nodiscard]] WireSections
encodeWireSections(const BuiltForest& built, const SeedTable& seeds, const AssetIdentity& identity);

/// Bytes that the messages of a section take on the wire.
[[nodiscard]] std::uint64_t wireBytes(std::span<const std::uint8_t> section);

}  // namespace limn
