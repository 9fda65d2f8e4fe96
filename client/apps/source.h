// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/core/connection.h"
#include "client/core/section_cache.h"
#include "client/net/lws_connection.h"

#include "shared/core/result.h"

#include <filesystem>
#include <memory>
#include <string>

namespace limn {

/// A source ready to be connected to.
struct Source {
  std::string model;
  ConnectionFactory connect;
  bool isServer = false;
  std::shared_ptr<SectionCache> cache{};  // null: nothing is kept
};

/// The server that the options name, with the token read. Errors: kInvalidArgument, kNotFound.
[[nodiscard]] Result<LwsConnectionOptions> serverOf(const SourceOptions& options);

/// Makes a source out of the options: reads the token, or reads the asset, or prepares the mesh
/// file with limn-prepare into a temporary store, which is gone when this returns.
/// Errors: whatever keeps the source from being used.
[[nodiscard]] Result<Source> openSource(const SourceOptions& options);

/// The source of one prepared asset.
[[nodiscard]] Result<Source> openAssetSource(const std::filesystem::path& directory);

}  // namespace limn
