// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/store/asset_store.h"
#include "server/store/file_ops.h"

#include <filesystem>
#include <memory>

namespace limn {

/// openDirectoryStore() with the steps it takes handed in: for fault injection.
[[nodiscard]] Result<std::unique_ptr<AssetStore>> openDirectoryStore(
    const std::filesystem::path& root,
    std::shared_ptr<FileOps> ops);

}  // namespace limn
