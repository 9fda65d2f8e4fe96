// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <string_view>

namespace limn {

/// A shared library opened at run time and kept until the process ends: GL drivers register exit
/// handlers and thread-local state that do not survive being unloaded.
class DynamicLibrary {
 public:
  /// soname: for example "libEGL.so.1"; package: the Debian package that has it, for the message.
  /// Errors: kUnavailable.
  [[nodiscard]] static Result<DynamicLibrary> open(const char* soname, std::string_view package);
  /// Null when the library has no such symbol.
  [[nodiscard]] void* symbol(const char* name) const;

 private:
  explicit DynamicLibrary(void* handle) : handle_(handle) {}

  void* handle_;
};

}  // namespace limn
