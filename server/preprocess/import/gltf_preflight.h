// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <string>
#include <string_view>

namespace limn::import {

/// Makes a glTF file (GLB or text) safe for a loader that trusts it: checks the container's
/// lengths, that the JSON is well-formed and not nested without end, that every required extension
/// is one that leaves plain geometry readable and that no buffer is outside the file; keeps only
/// what geometry needs. Returns a GLB.
[[nodiscard]] Result<std::string> preflightGltf(std::string_view bytes);

}  // namespace limn::import
