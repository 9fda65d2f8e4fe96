// SPDX-License-Identifier: Apache-2.0
#include "client/net/cache_directory.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr char kSuffix[] = ".limn";
/// While it is written; left behind by a program that was killed.
constexpr char kPartSuffix[] = ".limn-part";
constexpr std::size_t kHexDigits = 32;

/// Whether a file's name is one that this writes.
bool isOurs(const fs::path& path) {
  const std::string name = path.filename().string();
  const auto isHex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return name.size() > kHexDigits && std::all_of(name.begin(), name.begin() + kHexDigits, isHex) &&
         (name.substr(kHexDigits) == kSuffix || name.ends_with(kPartSuffix));
}

class CacheDirectory final : public SectionCache {
 public:
  explicit CacheDirectory(CacheDirectoryOptions options) : options_(std::move(options)) {}

  std::vector<std::uint8_t> load(const protocol::SectionHash& hash) override {
    const fs::path path = pathOf(hash);
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    if (error || size > options_.maxBytes) return {};
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
    std::ifstream file(path, std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
      return {};
    fs::last_write_time(path, fs::file_time_type::clock::now(), error);  // used: it stays longer
    return bytes;
  }

  void keep(const protocol::SectionHash& hash, std::span<const std::uint8_t> bytes) override {
    if (bytes.size() > options_.maxBytes) return;
    std::error_code error;
    fs::create_directories(options_.path, error);
    static std::atomic<unsigned> number{0};
    const fs::path part = options_.path / (protocol::toHex(hash) + "." + std::to_string(getpid()) +
                                           "-" + std::to_string(number++) + kPartSuffix);
    std::ofstream file(part, std::ios::binary);
    file.write(
        reinterpret_cast<const char*>(bytes.data()),
        static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (file) fs::rename(part, pathOf(hash), error);
    if (!file || error) fs::remove(part, error);
    makeRoom();
  }

 private:
  [[nodiscard]] fs::path pathOf(const protocol::SectionHash& hash) const {
    return options_.path / (protocol::toHex(hash) + kSuffix);
  }

  void makeRoom() const {
    struct Kept {
      fs::file_time_type used;
      std::uintmax_t bytes;
      fs::path path;
    };

    std::vector<Kept> files;
    std::uintmax_t total = 0;
    std::error_code error;
    for (fs::directory_iterator it(options_.path, error), end; !error && it != end;
         it.increment(error)) {
      std::error_code gone;  // another program may remove it meanwhile
      if (!isOurs(it->path()) || !it->is_regular_file(gone) || it->is_symlink(gone)) continue;
      const std::uintmax_t bytes = it->file_size(gone);
      const auto used = it->last_write_time(gone);
      if (gone) continue;
      files.push_back({used, bytes, it->path()});
      total += bytes;
    }
    std::ranges::sort(files, {}, &Kept::used);
    for (const Kept& file : files) {
      if (total <= options_.maxBytes) return;
      std::error_code gone;
      fs::remove(file.path, gone);
      total -= file.bytes;
    }
  }

  const CacheDirectoryOptions options_;
};

}  // namespace

std::shared_ptr<SectionCache> openCacheDirectory(CacheDirectoryOptions options) {
  return std::make_shared<CacheDirectory>(std::move(options));
}

}  // namespace limn
