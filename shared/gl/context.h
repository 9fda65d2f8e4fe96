// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/gl/api.h"

namespace limn {

/// An off-screen GL context with at least the abilities of GLES 3.0. Everything is drawn into
/// framebuffer objects, so a context has no surface worth the name.
/// Threads: made, used and destroyed on one thread. Contexts of one kind may change places on a
/// thread; two kinds at the same time need a thread each, since Mesa's EGL and OSMesa share the
/// thread's "current context".
class GlContext {
 public:
  virtual ~GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Makes this context current on the calling thread. Errors: kUnavailable.
  [[nodiscard]] virtual Result<void> makeCurrent() = 0;
  /// The entry points, valid as long as the context.
  [[nodiscard]] virtual const gl::Api& api() const = 0;

 protected:
  GlContext() = default;
};

}  // namespace limn
