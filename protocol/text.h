// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace limn::protocol {

/// Well-formed UTF-8 [RFC 3629].
[[nodiscard]] bool isUtf8(std::string_view text);

/// At most maxBytes of well-formed UTF-8 without control characters: safe in logs, JSON and on
/// terminals. Empty text passes.
[[nodiscard]] bool isText(std::string_view text, std::size_t maxBytes);

}  // namespace limn::protocol
