// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

/// What is wrong with a TOML text, in one line each: "line N: …", what to write instead included.
/// Who knows the file puts its name in front (Error::within). Lines count from 1, as toml++ does.
namespace limn {

/// "line N: WHAT", for what the others do not fit.
[[nodiscard]] std::string tomlError(std::size_t line, std::string_view what);

/// "line N: KEY must be WANTED": wanted, "a number from 1 to 9".
[[nodiscard]] std::string
wrongTomlValue(std::size_t line, std::string_view key, std::string_view wanted);

/// "line N: there is no key KEY; write one of …".
[[nodiscard]] std::string
unknownTomlKey(std::size_t line, std::string_view key, std::span<const std::string_view> known);

/// "a number from LOW to HIGH", for wrongTomlValue().
[[nodiscard]] std::string tomlNumberFrom(double low, double high);

}  // namespace limn
