// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace limn {

/// The steps a store takes to change a disk, one at a time, so that a test can stop, or fail,
/// between any two of them. Errors: kIo with the path and the reason. Threads: reentrant.
class FileOps {
 public:
  virtual ~FileOps() = default;
  /// Creates a file that must not exist, writes it whole and syncs it.
  [[nodiscard]] virtual Result<void> writeFile(
      const std::filesystem::path& file,
      std::span<const std::uint8_t> bytes);
  /// Syncs a directory, so that what was created in or renamed into it stays after a crash.
  [[nodiscard]] virtual Result<void> syncDirectory(const std::filesystem::path& directory);
  /// Atomic. Errors: kUnavailable when `to` is a directory that is not empty.
  [[nodiscard]] virtual Result<void> rename(
      const std::filesystem::path& from,
      const std::filesystem::path& to);
  [[nodiscard]] virtual Result<void> removeAll(const std::filesystem::path& path);
  [[nodiscard]] virtual Result<void> makeDirectory(const std::filesystem::path& directory);
};

/// A file descriptor that closes itself. Closing releases the flock() taken through it.
class Descriptor {
 public:
  Descriptor() = default;

  explicit Descriptor(int fd) : fd_(fd) {}

  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor();

  [[nodiscard]] int get() const { return fd_; }

  [[nodiscard]] bool valid() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// Opens a file or directory and takes its advisory lock without waiting. The lock dies with the
/// process, which is what tells leftovers from work in progress. Errors: kUnavailable (someone
/// holds it, or `path` no longer names what was locked), kIo.
[[nodiscard]] Result<Descriptor> tryLock(const std::filesystem::path& path);

/// Waits for the lock of `path`, a file that is created when missing.
[[nodiscard]] Result<Descriptor> waitForLock(const std::filesystem::path& path);

/// A file mapped read-only. Move-only.
class MappedFile {
 public:
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();
  /// Errors: kNotFound, kIo.
  [[nodiscard]] static Result<MappedFile> open(const std::filesystem::path& file);

  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return {data_, size_}; }

 private:
  MappedFile(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  const std::uint8_t* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace limn
