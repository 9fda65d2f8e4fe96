// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"
#include "client/apps/sweep_options.h"
#include "client/apps/view_options.h"

#include "shared/core/result.h"

#include <string>
#include <variant>
#include <vector>

namespace limn {

/// What goes to stdout, and that is all: help or the version.
struct PrintCommand {
  std::string text;
};

/// What the command line asks for.
using Command =
    std::variant<RenderCommandOptions, ViewCommandOptions, SweepCommandOptions, PrintCommand>;

/// Errors: kInvalidArgument and kUnsupported, in one line that says what to write instead.
[[nodiscard]] Result<Command> parseCommandLine(const std::vector<std::string>& arguments);

}  // namespace limn
