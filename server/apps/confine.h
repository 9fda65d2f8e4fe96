// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

namespace limn {

/// Gives up, for this process and for good, what reading and writing files and computing do not
/// need: sockets, other programs, other processes, privileges (seccomp; calls fail with EPERM).
/// For a program that is about to read somebody else's file. Errors: kUnavailable.
[[nodiscard]] Result<void> confineProcess();

}  // namespace limn
