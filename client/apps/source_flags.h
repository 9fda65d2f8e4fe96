// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/apps/render_options.h"

#include "shared/core/result.h"

namespace CLI {
class App;
}

namespace limn {

inline constexpr char kSourceGroup[] = "Source (one of three)";  // in --help

/// Flags that say which server, and which of its models.
void addServerFlags(CLI::App& app, SourceOptions& source);
/// Those, and the flags of an asset or a mesh file.
void addSourceFlags(CLI::App& app, SourceOptions& source);

/// Whether exactly one source is given, with what goes with it. Errors: kInvalidArgument.
[[nodiscard]] Result<void> checkSource(const SourceOptions& source);

}  // namespace limn
