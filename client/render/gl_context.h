// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/gl/api.h"

#include <memory>
#include <string_view>

namespace limn {

/// How a GL context is made: `--gl egl|osmesa`.
enum class GlBackend { kEgl, kOsmesa };

/// Parses `egl` or `osmesa`. Errors: kInvalidArgument, naming the choices.
[[nodiscard]] Result<GlBackend> parseGlBackend(std::string_view name);

/// An off-screen GL context with at least the abilities of GLES 3.0. Everything is drawn into
/// framebuffer objects, so a context has no surface worth the name.
/// Threads: made, used and destroyed on one thread. Contexts of one backend may change places on a
/// thread; two backends at the same time need a thread each, since Mesa's EGL and OSMesa share the
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

/// Opens the library behind `backend` at run time and makes a context that is current on return.
/// EGL: a hardware device if there is one, else Mesa's surfaceless software renderer; no display
/// server is needed. OSMesa: software, a 3.3 to 4.5 core context.
/// Errors: kUnavailable when the library or a suitable context is missing, saying what to install.
[[nodiscard]] Result<std::unique_ptr<GlContext>> createGlContext(GlBackend backend);

}  // namespace limn
