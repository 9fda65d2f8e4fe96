// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

namespace limn {

/// What every program of Limn ends with: 2 where the user can help it by writing other arguments, 1
/// for anything else that keeps it from its task.
inline constexpr int kExitSuccess = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

/// The status that a program ends with because of an error.
[[nodiscard]] inline int exitStatusOf(const Error& error) {
  return error.code == ErrorCode::kInvalidArgument ? kExitUsage : kExitFailed;
}

}  // namespace limn
