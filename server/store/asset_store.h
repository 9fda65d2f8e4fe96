// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/core/sha256.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// Section names of an asset. The wire sections are protocol messages as they are sent (each with
/// channel 0), framed as u32 little-endian length + FlatBuffer, one after another.
namespace sections {
inline constexpr char kInfo[] = "info";             // one ModelInfo
inline constexpr char kBase[] = "base";             // one Base
inline constexpr char kBlocks[] = "blocks";         // LevelBlocks, coarse to fine
inline constexpr char kPackets[] = "packets";       // Packets: every remaining split in level order
inline constexpr char kSeeds[] = "seeds";           // one Seeds
inline constexpr char kHullOuter[] = "hull-outer";  // one Hull, then HullSplits in order
inline constexpr char kHullInner[] = "hull-inner";  // the same
inline constexpr char kMapNormals[] = "map-normals";  // Maps in order
inline constexpr char kMapColors[] = "map-colors";    // the same
inline constexpr char kForest[] = "forest";           // serializeForest(): server only
}  // namespace sections

/// A committed asset, read-only. Sections were verified against their checksums when it was opened.
class Asset {
 public:
  virtual ~Asset() = default;
  [[nodiscard]] virtual const Sha256Digest& id() const = 0;
  /// The manifest's "report" object: what limn-prepare --json printed, as JSON text.
  [[nodiscard]] virtual const std::string& report() const = 0;
  /// Bytes of a section; valid as long as the asset. Errors: kNotFound.
  [[nodiscard]] virtual Result<std::span<const std::uint8_t>> section(
      std::string_view name) const = 0;
  /// All of them, in the order in which they were written.
  [[nodiscard]] virtual std::vector<std::string> sectionNames() const = 0;
};

/// An asset that is being written: aside, invisible until commit(). Destroyed without: removed.
class AssetWriter {
 public:
  virtual ~AssetWriter() = default;
  /// name: lower-case letters, digits and '-'; each once. Errors: kInvalidArgument, kIo (disk full,
  /// …).
  [[nodiscard]] virtual Result<void> addSection(
      std::string_view name,
      std::span<const std::uint8_t> bytes) = 0;
  /// Writes the manifest, syncs, renames into place. An intact asset of this id that is already
  /// there stays (the id names the content); a damaged one is quarantined and replaced. reportJson:
  /// an object. Call once. Errors: kInvalidArgument, kIo (disk full, …).
  [[nodiscard]] virtual Result<void> commit(const std::string& reportJson) = 0;
};

/// What a name stands for.
struct NameRecord {
  std::string name;
  Sha256Digest asset{};
  std::string source;  // path of the input it was made from, informative
};

/// Immutable assets keyed by content id, and the names that point to them. Every write is aside +
/// fsync + rename, so a crash at any moment leaves the old or the new state. Threads: reentrant.
class AssetStore {
 public:
  virtual ~AssetStore() = default;
  [[nodiscard]] virtual bool contains(const Sha256Digest& id) const = 0;
  /// Opens and verifies every section. Errors: kNotFound, kCorrupt (then quarantine() makes room).
  [[nodiscard]] virtual Result<std::shared_ptr<const Asset>> open(const Sha256Digest& id) const = 0;
  [[nodiscard]] virtual Result<std::unique_ptr<AssetWriter>> create(const Sha256Digest& id) = 0;
  /// Moves a damaged asset out of the way so that it can be prepared again.
  [[nodiscard]] virtual Result<void> quarantine(const Sha256Digest& id) = 0;

  /// Points a name at an asset; replaces what it pointed at. name: 1 to 200 bytes of UTF-8.
  /// Errors: kInvalidArgument, kNotFound (no such asset), kIo.
  [[nodiscard]] virtual Result<void> setName(const NameRecord& record) = 0;
  /// Errors: kNotFound, kIo.
  [[nodiscard]] virtual Result<void> removeName(std::string_view name) = 0;
  /// Every readable name, sorted.
  [[nodiscard]] virtual Result<std::vector<NameRecord>> names() const = 0;
  /// File names of the name records that names() had to leave out because they are damaged.
  [[nodiscard]] virtual Result<std::vector<std::string>> damagedNames() const = 0;

  /// Removes the assets that no name points at, but for those written less than minimumAge ago
  /// (their name may be on its way). Does nothing while a name is damaged: it may point at any of
  /// them. Returns how many went. Assets that are open stay readable.
  [[nodiscard]] virtual Result<std::size_t> removeUnreferenced(std::chrono::seconds minimumAge) = 0;
};

/// The embedded store: one directory. FORMAT.md has its layout. Creates it when missing.
[[nodiscard]] Result<std::unique_ptr<AssetStore>> openDirectoryStore(
    const std::filesystem::path& root);

}  // namespace limn
