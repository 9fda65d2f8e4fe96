// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"

#include "shared/core/result.h"

namespace limn {

/// `limn-client render --with`: several models in one picture, each streamed by a session of its
/// own. Progress goes to stderr. Errors: one line a user can act on.
[[nodiscard]] Result<void> runScene(const RenderCommandOptions& options);

}  // namespace limn
