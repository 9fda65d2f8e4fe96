// SPDX-License-Identifier: Apache-2.0
#include "shared/gl/dynamic_library.h"

#include <dlfcn.h>

#include <string>

namespace limn {

Result<DynamicLibrary> DynamicLibrary::open(const char* soname, std::string_view package) {
  // Local: EGL's and OSMesa's gl* symbols must not see each other.
  void* handle = dlopen(soname, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    return fail(
        ErrorCode::kUnavailable,
        "cannot load " + std::string(soname) + ": install the package " + std::string(package));
  }
  return DynamicLibrary(handle);
}

void* DynamicLibrary::symbol(const char* name) const {
  return dlsym(handle_, name);
}

}  // namespace limn
