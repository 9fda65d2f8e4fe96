// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace limn {

/// How a child process ended.
struct ChildResult {
  int exitCode = 0;       // 128 + signal when a signal ended it
  std::string output;     // its stdout
  std::string complaint;  // its stderr
};

/// Runs a program to its end and collects what it writes (at most 16 MiB each, the rest is
/// dropped). shouldStop is asked now and then; when it says yes the child is killed.
/// Errors: kIo (cannot start), kCancelled.
[[nodiscard]] Result<ChildResult> runChild(
    const std::vector<std::string>& arguments,
    const std::function<bool()>& shouldStop);

/// A program of this release: beside the running one, else whatever PATH has under that name.
[[nodiscard]] std::string siblingProgram(const std::string& name);

}  // namespace limn
