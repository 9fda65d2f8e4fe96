// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/section_cache.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace limn {

struct CacheDirectoryOptions {
  std::filesystem::path path;                         // made when the first thing is kept
  std::uint64_t maxBytes = std::uint64_t{256} << 20;  // of all; what was not used longest goes
};

/// A cache in files, HASH.limn, beside which others may lie: those are never touched. A file
/// appears whole or not at all, also where several programs share the directory. A directory that
/// cannot be written keeps nothing.
[[nodiscard]] std::shared_ptr<SectionCache> openCacheDirectory(CacheDirectoryOptions options);

}  // namespace limn
