// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/gl/api.h"

#include <memory>

namespace limn {

/// A software GL context without a window, for pictures that preparation computes with. Threads:
/// belongs to the thread that created it and is current there until it is destroyed.
class OffscreenContext {
 public:
  OffscreenContext() = default;
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;
  virtual ~OffscreenContext() = default;
  [[nodiscard]] virtual const gl::Api& api() const = 0;
};

/// Loads OSMesa at run time (soname: which library to load). Errors: kUnavailable, saying what to
/// install.
[[nodiscard]] Result<std::unique_ptr<OffscreenContext>> createOffscreenContext(
    const char* soname = "libOSMesa.so.8");

}  // namespace limn
