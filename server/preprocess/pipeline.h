// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/forest/build_forest.h"
#include "server/preprocess/hulls/build_hull.h"
#include "server/preprocess/repair/repair.h"
#include "server/store/asset_store.h"

#include "shared/core/result.h"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace limn {

/// Everything that decides the bytes of an asset, besides the input file.
struct PrepareOptions {
  RepairOptions repair;
  ForestOptions forest;
  int seedAzimuths = 8;
  int seedElevations = 5;
  HullOptions hull;
  std::uint32_t hullFaces =
      500;  // the level of the hulls that has maps and that the report measures
};

struct PreparedModel {
  std::string name;
  Sha256Digest asset{};
  TriangleMesh mesh;       // what is streamed, vertices by permanent id
  std::string note;        // what the user should know about the result; empty: nothing
  std::string reportJson;  // limn-prepare --json
};

/// Told which stage begins and how much of the whole is done, 0 to 1.
using Progress = std::function<void(std::string_view stage, double done)>;

/// Prepares a mesh file into an asset of `store` and points `name` at it. An asset that the store
/// already has, undamaged, is used as it is; a damaged one is prepared again.
/// Errors: those of importMesh, repairMesh and the store. Blocking: some 20 µs a face.
[[nodiscard]] Result<PreparedModel> prepareModel(
    const std::filesystem::path& input,
    const std::string& name,
    const PrepareOptions& options,
    AssetStore& store,
    const Progress& progress);

}  // namespace limn
