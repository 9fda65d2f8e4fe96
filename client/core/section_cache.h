// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/section_hash.h"

#include <cstdint>
#include <span>
#include <vector>

namespace limn {

/// Where a client keeps parts of streams from one session to the next, by what they are: owned by
/// this folder, implemented by client/net. What comes back is checked against its hash before it is
/// used, so a cache may lose or damage anything.
/// Threads: any, one call at a time a session.
class SectionCache {
 public:
  SectionCache() = default;
  virtual ~SectionCache() = default;
  SectionCache(const SectionCache&) = delete;
  SectionCache& operator=(const SectionCache&) = delete;

  /// Empty: not there.
  [[nodiscard]] virtual std::vector<std::uint8_t> load(const protocol::SectionHash& hash) = 0;
  /// Replaces what was there. May fail without a word: it is a cache.
  virtual void keep(const protocol::SectionHash& hash, std::span<const std::uint8_t> bytes) = 0;
};

}  // namespace limn
