// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/gl/context.h"

#include <memory>

namespace limn {

/// A software context: a 4.3 or 4.5 core profile, which compiles `#version 300 es`. Current on
/// return. Loads OSMesa at run time (soname: which library).
/// Errors: kUnavailable, saying what to install.
[[nodiscard]] Result<std::unique_ptr<GlContext>> createOsmesaContext(
    const char* soname = "libOSMesa.so.8");

}  // namespace limn
