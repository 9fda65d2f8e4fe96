// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace limn {

/// Says on stderr, in one line that begins with the program's name, what is wrong. Returns
/// `status`, for main().
int complain(std::string_view program, int status, std::string_view message);

/// What a complaint about an option becomes.
using Explain = std::function<std::string(const std::string& complaint)>;

/// Parses a command line. nullopt: go on. Otherwise the program's exit status: help was printed, or
/// what is wrong with the arguments, explained if there is something to explain.
[[nodiscard]] std::optional<int>
parseArguments(CLI::App& app, int argc, char** argv, const Explain& explain = {});

}  // namespace limn
