// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/store/asset_store.h"

#include "shared/core/result.h"
#include "shared/core/sha256.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

inline constexpr int kStoreFormat = 1;
inline constexpr std::size_t kMaxStoreNameBytes = 200;

/// What manifest.json says of an asset. FORMAT.md has the text form.
struct Manifest {
  struct Section {
    std::string name;
    std::string file;  // beside the manifest
    std::uint64_t bytes = 0;
    Sha256Digest sha256{};
  };

  Sha256Digest id{};
  std::vector<Section> sections;
  std::string report;  // JSON object
};

/// Errors: kInvalidArgument when the report is not a JSON object.
[[nodiscard]] Result<std::string> serializeManifest(const Manifest& manifest);
/// Total over any bytes. Errors: kCorrupt, kUnsupported (another format version).
[[nodiscard]] Result<Manifest> parseManifest(std::span<const std::uint8_t> text);

/// "asset_format" of an asset's report, which says what its sections hold; 0 where there is none,
/// as in assets of before formats were told.
[[nodiscard]] int assetFormatOf(const std::string& reportJson);

/// Whether a section can have this name: 1 to 64 lower-case letters, digits, '-'.
[[nodiscard]] bool isSectionName(std::string_view name);
/// Whether a model can have this name: 1 to kMaxStoreNameBytes of UTF-8 without control characters.
[[nodiscard]] bool isModelName(std::string_view name);

[[nodiscard]] std::optional<Sha256Digest> digestFromHex(std::string_view hex);

/// The text of a name's file, its own checksum included, and back. Errors: kCorrupt.
[[nodiscard]] std::string serializeNameRecord(const NameRecord& record);
[[nodiscard]] Result<NameRecord> parseNameRecord(std::span<const std::uint8_t> text);
/// The file that keeps a name's record: letters, digits, '.', '-' and '_' stand for themselves, any
/// other byte is %XX; a name too long for a file so gets its hash.
[[nodiscard]] std::string nameFile(std::string_view name);

}  // namespace limn
