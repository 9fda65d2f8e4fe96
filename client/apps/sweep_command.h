// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/sweep_options.h"

#include "shared/core/result.h"

namespace limn {

/// Runs `limn-client sweep`: every detector along a path around every model. Prints a table on
/// stdout. Errors: whatever keeps a model from being loaded or an output from being written.
[[nodiscard]] Result<void> runSweep(const SweepCommandOptions& options);

}  // namespace limn
