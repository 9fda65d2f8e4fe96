// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace limn {

/// The path of frame `index`: `%04d` (or `%d`) replaced by it. Without one: `pattern` itself.
[[nodiscard]] std::string framePath(const std::string& pattern, std::uint32_t index);

/// Whether a path has a place for the frame's number.
[[nodiscard]] bool hasFrameNumber(const std::string& pattern);

}  // namespace limn
