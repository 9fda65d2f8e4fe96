// SPDX-License-Identifier: Apache-2.0
#include "client/apps/temporary_directory.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

namespace limn {

Result<std::unique_ptr<TemporaryDirectory>> TemporaryDirectory::create() {
  std::error_code error;
  auto folder = std::filesystem::temp_directory_path(error);
  if (error) folder = "/tmp";
  std::string pattern = (folder / "limn-client-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    return fail(
        ErrorCode::kIo,
        "cannot make a temporary directory in " + folder.string() + ": " + std::strerror(errno));
  }
  return std::unique_ptr<TemporaryDirectory>(new TemporaryDirectory(pattern));
}

TemporaryDirectory::TemporaryDirectory(std::filesystem::path path) : path_(std::move(path)) {}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace limn
