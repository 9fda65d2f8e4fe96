// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/model.h"
#include "server/store/asset_store.h"

#include "shared/codec/attribute_codec.h"
#include "shared/codec/split_bits.h"
#include "shared/core/result.h"

#include <cstdint>
#include <string>
#include <vector>

namespace limn {

/// What a part of an asset costs. A wire section's bytes include the WebSocket frame headers of its
/// messages.
struct SectionBytes {
  std::string name;            // see sections:: in asset_store.h
  std::uint64_t messages = 0;  // 0: of the server only, never sent
  std::uint64_t bytes = 0;
};

/// What a level costs when all of it is sent.
struct LevelBytes {
  std::uint32_t level = 0;
  std::uint32_t vertices = 0;  // of the mesh up to this level
  std::uint32_t faces = 0;
  std::uint64_t bytes = 0;  // frame headers included
  double rmsError = 0.0;    // to the full mesh, model units
  SplitBits bits;           // of its splits, what they hold by kind of symbol
  AttributeBits attributes;
};

/// Where the bytes of an asset go.
struct ByteAccount {
  std::vector<SectionBytes> sections;
  std::vector<LevelBytes> levels;      // 0: the base mesh
  std::uint64_t splitModelBytes = 0;   // of the info section: tables of the split coder
  std::uint64_t baseFeatureBytes = 0;  // of the base section
};

/// Errors: kCorrupt (the sections do not belong together). Cost: O(asset).
[[nodiscard]] Result<ByteAccount> accountBytes(const Asset& asset, const Model& model);

}  // namespace limn
