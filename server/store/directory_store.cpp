// SPDX-License-Identifier: Apache-2.0
//
// The embedded store. Everything new is written below tmp/, synced, and renamed to where it counts;
// the rename is the commit. Whatever lies in tmp/ is locked by the process that writes it, so what
// nobody locks is a leftover of a process that died.
#include "server/store/directory_store.h"

#include "server/store/manifest.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <system_error>
#include <utility>

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr char kManifestFile[] = "manifest.json";
constexpr char kManifestChecksumFile[] = "manifest.sha256";

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string checksumLine(std::span<const std::uint8_t> manifest) {
  return toHex(sha256(manifest)) + "\n";
}

/// What is in a directory, unsorted. Errors: kIo.
Result<std::vector<fs::path>> entriesOf(const fs::path& directory) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  if (error) {
    return fail(ErrorCode::kIo, "cannot list " + directory.string() + ": " + error.message());
  }
  return entries;
}

/// Paths of a store, and a name below tmp/ that nobody else has.
struct Layout {
  fs::path root;

  [[nodiscard]] fs::path assets() const { return root / "assets"; }

  [[nodiscard]] fs::path asset(const Sha256Digest& id) const { return assets() / toHex(id); }

  [[nodiscard]] fs::path names() const { return root / "names"; }

  [[nodiscard]] fs::path tmp() const { return root / "tmp"; }

  [[nodiscard]] fs::path quarantine() const { return root / "quarantine"; }

  [[nodiscard]] fs::path lock() const { return root / "lock"; }

  [[nodiscard]] fs::path aside(const std::string& stem) const {
    static std::atomic<std::uint64_t> counter{0};
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    return tmp() / (stem + "." + std::to_string(::getpid()) + "." + std::to_string(now) + "." +
                    std::to_string(counter++));
  }
};

class DirectoryAsset final : public Asset {
 public:
  DirectoryAsset(Manifest manifest, std::map<std::string, MappedFile, std::less<>> files)
      : manifest_(std::move(manifest)),
        files_(std::move(files)) {}

  const Sha256Digest& id() const override { return manifest_.id; }

  const std::string& report() const override { return manifest_.report; }

  Result<std::span<const std::uint8_t>> section(std::string_view name) const override {
    const auto file = files_.find(name);
    if (file == files_.end()) {
      return fail(
          ErrorCode::kNotFound,
          "asset " + toHex(manifest_.id) + " has no section '" + std::string(name) + "'");
    }
    return file->second.bytes();
  }

  std::vector<std::string> sectionNames() const override {
    std::vector<std::string> names;
    for (const Manifest::Section& section : manifest_.sections)
      names.push_back(section.name);
    return names;
  }

 private:
  Manifest manifest_;
  std::map<std::string, MappedFile, std::less<>> files_;
};

/// Reads and verifies one asset's directory.
Result<std::shared_ptr<const Asset>> openAsset(const fs::path& directory, const Sha256Digest& id) {
  std::error_code error;
  if (!fs::is_directory(directory, error)) {
    return fail(ErrorCode::kNotFound, "there is no asset " + directory.string());
  }
  const auto corrupt = [&](const std::string& what) {
    return fail(
        ErrorCode::kCorrupt,
        directory.string() + ": " + what + "; prepare the model again");
  };
  const auto text = MappedFile::open(directory / kManifestFile);
  const auto checksum = MappedFile::open(directory / kManifestChecksumFile);
  if (!text || !checksum) return corrupt("its manifest is missing");
  if (!std::ranges::equal(checksumLine(text->bytes()), checksum->bytes(), {}, [](char c) {
        return static_cast<std::uint8_t>(c);
      })) {
    return corrupt("its manifest does not match its checksum");
  }
  auto manifest = parseManifest(text->bytes());
  if (!manifest) return tl::unexpected(manifest.error().within(directory.string()));
  if (manifest->id != id) return corrupt("its manifest is of another asset");
  std::map<std::string, MappedFile, std::less<>> files;
  for (const Manifest::Section& section : manifest->sections) {
    auto file = MappedFile::open(directory / section.file);
    if (!file) return corrupt("section '" + section.name + "' is missing");
    if (file->bytes().size() != section.bytes || sha256(file->bytes()) != section.sha256) {
      return corrupt("section '" + section.name + "' does not match its checksum");
    }
    files.emplace(section.name, std::move(*file));
  }
  return std::make_shared<const DirectoryAsset>(std::move(*manifest), std::move(files));
}

Result<void> quarantineAsset(FileOps& ops, const Layout& layout, const Sha256Digest& id) {
  // The first free number; two quarantines at once race for it, and the loser takes the next.
  for (int i = 0; i < 10000; ++i) {
    const fs::path to = layout.quarantine() / (toHex(id) + "." + std::to_string(i));
    std::error_code error;
    if (fs::exists(to, error)) continue;
    const auto moved = ops.rename(layout.asset(id), to);
    if (moved) return ops.syncDirectory(layout.assets());
    if (moved.error().code != ErrorCode::kUnavailable) return moved;
  }
  return fail(
      ErrorCode::kIo,
      layout.quarantine().string() + " is full of copies of one asset; empty it");
}

class DirectoryWriter final : public AssetWriter {
 public:
  DirectoryWriter(
      std::shared_ptr<FileOps> ops,
      Layout layout,
      const Sha256Digest& id,
      fs::path aside,
      Descriptor lock)
      : ops_(std::move(ops)),
        layout_(std::move(layout)),
        aside_(std::move(aside)),
        lock_(std::move(lock)) {
    manifest_.id = id;
  }

  ~DirectoryWriter() override {
    // A failure leaves a leftover for the next opening of the store.
    if (!committed_) static_cast<void>(ops_->removeAll(aside_));
  }

  Result<void> addSection(std::string_view name, std::span<const std::uint8_t> bytes) override {
    if (!isSectionName(name)) {
      return fail(ErrorCode::kInvalidArgument, "'" + std::string(name) + "' cannot name a section");
    }
    for (const Manifest::Section& before : manifest_.sections) {
      if (before.name == name) {
        return fail(ErrorCode::kInvalidArgument, "section '" + before.name + "' is there twice");
      }
    }
    Manifest::Section section{
        std::string(name),
        std::string(name) + ".bin",
        bytes.size(),
        sha256(bytes)};
    if (auto written = ops_->writeFile(aside_ / section.file, bytes); !written) return written;
    manifest_.sections.push_back(std::move(section));
    return {};
  }

  Result<void> commit(const std::string& reportJson) override {
    manifest_.report = reportJson;
    const auto text = serializeManifest(manifest_);
    if (!text) return tl::unexpected(text.error());
    const std::string checksum = checksumLine(bytesOf(*text));
    for (const auto& [file, content] :
         {std::pair(kManifestFile, &*text), std::pair(kManifestChecksumFile, &checksum)}) {
      if (auto written = ops_->writeFile(aside_ / file, bytesOf(*content)); !written)
        return written;
    }
    if (auto synced = ops_->syncDirectory(aside_); !synced) return synced;
    const fs::path place = layout_.asset(manifest_.id);
    // Twice over: what is in the way may be damaged, or another writer of the same id may win.
    for (int attempt = 0; attempt < 3; ++attempt) {
      const auto renamed = ops_->rename(aside_, place);
      if (renamed) {
        committed_ = true;
        return ops_->syncDirectory(layout_.assets());
      }
      if (renamed.error().code != ErrorCode::kUnavailable) return renamed;
      if (openAsset(place, manifest_.id)) return {};
      if (auto moved = quarantineAsset(*ops_, layout_, manifest_.id); !moved) {
        std::error_code error;
        if (fs::exists(place, error)) return moved;
      }
    }
    return fail(ErrorCode::kIo, place.string() + " keeps coming back damaged; check the disk");
  }

 private:
  std::shared_ptr<FileOps> ops_;
  Layout layout_;
  fs::path aside_;
  Descriptor lock_;  // of aside_, for as long as this writer lives
  Manifest manifest_;
  bool committed_ = false;
};

class DirectoryStore final : public AssetStore {
 public:
  DirectoryStore(Layout layout, std::shared_ptr<FileOps> ops)
      : layout_(std::move(layout)),
        ops_(std::move(ops)) {}

  bool contains(const Sha256Digest& id) const override {
    std::error_code error;
    return fs::exists(layout_.asset(id) / kManifestFile, error);
  }

  Result<std::shared_ptr<const Asset>> open(const Sha256Digest& id) const override {
    return openAsset(layout_.asset(id), id);
  }

  Result<std::unique_ptr<AssetWriter>> create(const Sha256Digest& id) override {
    // A collector that sees the directory before it is locked takes it; then another name is tried.
    for (int attempt = 0; attempt < 100; ++attempt) {
      const fs::path aside = layout_.aside(toHex(id));
      if (auto made = ops_->makeDirectory(aside); !made) return tl::unexpected(made.error());
      auto lock = tryLock(aside);
      if (!lock) continue;
      return std::make_unique<DirectoryWriter>(ops_, layout_, id, aside, std::move(*lock));
    }
    return fail(ErrorCode::kIo, "cannot lock a new directory below " + layout_.tmp().string());
  }

  Result<void> quarantine(const Sha256Digest& id) override {
    std::error_code error;
    if (!fs::exists(layout_.asset(id), error)) {
      return fail(ErrorCode::kNotFound, "there is no asset " + toHex(id));
    }
    return quarantineAsset(*ops_, layout_, id);
  }

  Result<void> setName(const NameRecord& record) override {
    if (!isModelName(record.name)) {
      return fail(
          ErrorCode::kInvalidArgument,
          "'" + record.name + "' cannot name a model: 1 to " + std::to_string(kMaxStoreNameBytes) +
              " bytes of UTF-8, no control characters");
    }
    // The store's lock keeps removeUnreferenced() from taking the asset before it has its name.
    const auto lock = waitForLock(layout_.lock());
    if (!lock) return tl::unexpected(lock.error());
    if (!contains(record.asset)) {
      return fail(
          ErrorCode::kNotFound,
          "'" + record.name + "' cannot name asset " + toHex(record.asset) + ": it is not there");
    }
    const fs::path aside = layout_.aside("name");
    if (auto written = ops_->writeFile(aside, bytesOf(serializeNameRecord(record))); !written) {
      static_cast<void>(ops_->removeAll(aside));
      return written;
    }
    if (auto renamed = ops_->rename(aside, layout_.names() / nameFile(record.name)); !renamed) {
      static_cast<void>(ops_->removeAll(aside));
      return renamed;
    }
    return ops_->syncDirectory(layout_.names());
  }

  Result<void> removeName(std::string_view name) override {
    const auto lock = waitForLock(layout_.lock());
    if (!lock) return tl::unexpected(lock.error());
    const fs::path file = layout_.names() / nameFile(name);
    std::error_code error;
    if (!fs::exists(file, error)) {
      return fail(ErrorCode::kNotFound, "no model is named '" + std::string(name) + "'");
    }
    if (auto removed = ops_->removeAll(file); !removed) return removed;
    return ops_->syncDirectory(layout_.names());
  }

  Result<std::vector<NameRecord>> names() const override {
    auto read = readNames();
    if (!read) return tl::unexpected(read.error());
    return std::move(read->records);
  }

  Result<std::vector<std::string>> damagedNames() const override {
    auto read = readNames();
    if (!read) return tl::unexpected(read.error());
    return std::move(read->damaged);
  }

  Result<std::size_t> removeUnreferenced(std::chrono::seconds minimumAge) override {
    const auto lock = waitForLock(layout_.lock());
    if (!lock) return tl::unexpected(lock.error());
    const auto read = readNames();
    if (!read) return tl::unexpected(read.error());
    if (!read->damaged.empty()) return std::size_t{0};
    const auto entries = entriesOf(layout_.assets());
    if (!entries) return tl::unexpected(entries.error());
    std::size_t removed = 0;
    const auto newest = fs::file_time_type::clock::now() - minimumAge;
    for (const fs::path& entry : *entries) {
      const auto id = digestFromHex(entry.filename().string());
      if (!id) continue;
      const bool named = std::ranges::any_of(read->records, [&](const NameRecord& record) {
        return record.asset == *id;
      });
      // Not the directory's own time: some file systems move it when it is renamed.
      std::error_code error;
      const auto written = fs::last_write_time(entry / kManifestFile, error);
      if (named || (!error && written > newest)) continue;
      // Renamed away first, so that a crash half-way leaves no half asset.
      const fs::path aside = layout_.aside("removed");
      if (auto moved = ops_->rename(entry, aside); !moved) return tl::unexpected(moved.error());
      if (auto gone = ops_->removeAll(aside); !gone) return tl::unexpected(gone.error());
      ++removed;
    }
    return removed;
  }

  /// Removes what dead processes left below tmp/.
  void collectLeftovers() {
    // Names are written and assets removed under the store's lock; assets in the making are locked
    // one by one, and that lock is held until the entry is gone, so that a writer that has just
    // made it notices.
    const auto storeLock = waitForLock(layout_.lock());
    const auto entries = entriesOf(layout_.tmp());
    if (!storeLock || !entries) return;
    for (const fs::path& entry : *entries) {
      const auto lock = tryLock(entry);
      if (lock) static_cast<void>(ops_->removeAll(entry));
    }
  }

 private:
  struct NameList {
    std::vector<NameRecord> records;
    std::vector<std::string> damaged;
  };

  Result<NameList> readNames() const {
    NameList list;
    const auto entries = entriesOf(layout_.names());
    if (!entries) return tl::unexpected(entries.error());
    for (const fs::path& entry : *entries) {
      const std::string file = entry.filename().string();
      const auto text = MappedFile::open(entry);
      if (!text && text.error().code == ErrorCode::kNotFound) continue;  // removed meanwhile
      auto record =
          text ? parseNameRecord(text->bytes()) : Result<NameRecord>(tl::unexpected(text.error()));
      if (record && nameFile(record->name) == file) {
        list.records.push_back(std::move(*record));
      } else {
        list.damaged.push_back(file);
      }
    }
    std::ranges::sort(list.records, {}, &NameRecord::name);
    std::ranges::sort(list.damaged);
    return list;
  }

  Layout layout_;
  std::shared_ptr<FileOps> ops_;
};

}  // namespace

Result<std::unique_ptr<AssetStore>> openDirectoryStore(
    const fs::path& root,
    std::shared_ptr<FileOps> ops) {
  Layout layout{root};
  for (const fs::path& directory :
       {layout.assets(), layout.names(), layout.tmp(), layout.quarantine()}) {
    std::error_code error;
    fs::create_directories(directory, error);
    if (error) {
      return fail(
          ErrorCode::kIo,
          "cannot make a store at " + root.string() + ": " + error.message() +
              "; give a directory that can be written");
    }
  }
  auto store = std::make_unique<DirectoryStore>(std::move(layout), std::move(ops));
  store->collectLeftovers();
  return store;
}

Result<std::unique_ptr<AssetStore>> openDirectoryStore(const fs::path& root) {
  return openDirectoryStore(root, std::make_shared<FileOps>());
}

}  // namespace limn
