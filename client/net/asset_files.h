// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace limn {

/// The wire messages of a prepared asset, in the order in which a client takes them. The format is
/// described in server/store/FORMAT.md; this reads it without any code of the server.
struct AssetFiles {
  std::string name;                                // of the model, as the preparation had it
  std::vector<std::uint8_t> info;                  // ModelInfo
  std::vector<std::vector<std::uint8_t>> payload;  // Base, LevelBlocks, Seeds, Packets
  /// Of the outer and the inner hull: Hull, then HullSplits in order; empty: none.
  std::array<std::vector<std::vector<std::uint8_t>>, 2> hulls;
  std::array<std::vector<std::vector<std::uint8_t>>, 2> maps;  // by MapKind, in order; empty: none
};

/// Reads an asset directory and verifies the checksum of everything it takes from it.
/// Errors: kNotFound (no asset there), kCorrupt (damaged: prepare it again), kIo, kUnsupported
/// (another format).
[[nodiscard]] Result<AssetFiles> readAssetFiles(const std::filesystem::path& directory);

}  // namespace limn
