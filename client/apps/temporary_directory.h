// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <filesystem>
#include <memory>

namespace limn {

/// A fresh private directory under the system's temporary folder, removed with everything in it
/// when the object goes.
class TemporaryDirectory {
 public:
  /// Errors: kIo.
  [[nodiscard]] static Result<std::unique_ptr<TemporaryDirectory>> create();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryDirectory(std::filesystem::path path);
  std::filesystem::path path_;
};

}  // namespace limn
