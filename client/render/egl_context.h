// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/render/gl_context.h"

namespace limn {

/// See createGlContext.
[[nodiscard]] Result<std::unique_ptr<GlContext>> createEglContext();

}  // namespace limn
