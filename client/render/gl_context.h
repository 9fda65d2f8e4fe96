// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"
#include "shared/gl/context.h"

#include <memory>
#include <string_view>

namespace limn {

/// How a GL context is made: `--gl egl|osmesa`.
enum class GlBackend { kEgl, kOsmesa };

/// Parses `egl` or `osmesa`. Errors: kInvalidArgument, naming the choices.
[[nodiscard]] Result<GlBackend> parseGlBackend(std::string_view name);

/// Opens the library behind `backend` at run time and makes a context that is current on return.
/// EGL: a hardware device if there is one, else Mesa's surfaceless software renderer; no display
/// server is needed. OSMesa: software, a 3.3 to 4.5 core context.
/// Errors: kUnavailable when the library or a suitable context is missing, saying what to install.
[[nodiscard]] Result<std::unique_ptr<GlContext>> createGlContext(GlBackend backend);

}  // namespace limn
