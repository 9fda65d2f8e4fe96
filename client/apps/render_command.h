// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"

#include "shared/core/result.h"

namespace limn {

/// `limn-client render`: streams a model until the state asked for, draws it, writes what was asked
/// for. Progress goes to stderr. Errors: one line a user can act on.
[[nodiscard]] Result<void> runRender(const RenderCommandOptions& options);

}  // namespace limn
