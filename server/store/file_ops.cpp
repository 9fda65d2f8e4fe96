// SPDX-License-Identifier: Apache-2.0
#include "server/store/file_ops.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace limn {
namespace {

tl::unexpected<Error> systemError(const char* what, const std::filesystem::path& path, int code) {
  std::string message = std::string("cannot ") + what + " " + path.string() + ": " +
                        std::generic_category().message(code);
  if (code == ENOSPC || code == EDQUOT) message += "; free some space there and try again";
  return fail(ErrorCode::kIo, std::move(message));
}

}  // namespace

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

Result<void> FileOps::writeFile(
    const std::filesystem::path& file,
    std::span<const std::uint8_t> bytes) {
  const Descriptor fd(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (!fd.valid()) return systemError("create", file, errno);
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd.get(), bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      return systemError("write", file, errno);
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  if (::fsync(fd.get()) != 0) return systemError("sync", file, errno);
  return {};
}

Result<void> FileOps::syncDirectory(const std::filesystem::path& directory) {
  const Descriptor fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.valid()) return systemError("open", directory, errno);
  if (::fsync(fd.get()) != 0) return systemError("sync", directory, errno);
  return {};
}

Result<void> FileOps::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) == 0) return {};
  if (errno == ENOTEMPTY || errno == EEXIST) {
    return fail(ErrorCode::kUnavailable, to.string() + " is already there");
  }
  return systemError("rename to", to, errno);
}

Result<void> FileOps::removeAll(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::remove_all(path, error);
  if (error) return systemError("remove", path, error.value());
  return {};
}

Result<void> FileOps::makeDirectory(const std::filesystem::path& directory) {
  if (::mkdir(directory.c_str(), 0755) != 0) return systemError("create", directory, errno);
  return {};
}

Result<Descriptor> tryLock(const std::filesystem::path& path) {
  Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!fd.valid()) return systemError("open", path, errno);
  if (::flock(fd.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return fail(ErrorCode::kUnavailable, path.string() + " is in use");
    return systemError("lock", path, errno);
  }

  struct stat held {};

  struct stat named {};

  if (::fstat(fd.get(), &held) != 0 || ::stat(path.c_str(), &named) != 0 ||
      held.st_ino != named.st_ino || held.st_dev != named.st_dev) {
    return fail(ErrorCode::kUnavailable, path.string() + " went away");
  }
  return fd;
}

Result<Descriptor> waitForLock(const std::filesystem::path& path) {
  Descriptor fd(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!fd.valid()) return systemError("open", path, errno);
  while (::flock(fd.get(), LOCK_EX) != 0) {
    if (errno != EINTR) return systemError("lock", path, errno);
  }
  return fd;
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<std::uint8_t*>(data_), size_);
}

Result<MappedFile> MappedFile::open(const std::filesystem::path& file) {
  const Descriptor fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!fd.valid()) {
    if (errno == ENOENT || errno == ENOTDIR) {
      return fail(ErrorCode::kNotFound, "there is no " + file.string());
    }
    return systemError("open", file, errno);
  }

  struct stat status {};

  if (::fstat(fd.get(), &status) != 0) return systemError("read", file, errno);
  if (!S_ISREG(status.st_mode)) {
    return fail(ErrorCode::kIo, file.string() + " is not a regular file");
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return MappedFile(nullptr, 0);
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd.get(), 0);
  if (data == MAP_FAILED) return systemError("map", file, errno);
  return MappedFile(static_cast<const std::uint8_t*>(data), size);
}

}  // namespace limn
