// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/view_options.h"

#include "shared/core/result.h"

namespace limn {

/// `limn-client view`: a window onto a model, until it is closed. Errors: no window can be opened,
/// or the source cannot be used at all; what goes wrong later is shown in the window.
[[nodiscard]] Result<void> runView(const ViewCommandOptions& options);

}  // namespace limn
