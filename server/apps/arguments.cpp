// SPDX-License-Identifier: Apache-2.0
#include "server/apps/arguments.h"

#include "shared/core/exit_status.h"

#include <CLI/CLI.hpp>

#include <iostream>
#include <string>

namespace limn {

int complain(std::string_view program, int status, std::string_view message) {
  std::cerr << program << ": " << message << '\n';
  return status;
}

std::optional<int> parseArguments(CLI::App& app, int argc, char** argv, const Explain& explain) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return complain(
        app.get_name(),
        kExitUsage,
        (explain ? explain(error.what()) : std::string(error.what())) + " (see " + app.get_name() +
            " --help)");
  }
  return std::nullopt;
}

}  // namespace limn
