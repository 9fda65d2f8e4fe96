// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstddef>
#include <map>
#include <span>
#include <string>

namespace CLI {
class App;
}

namespace limn {

/// Where options stand in a TOML file of them, so that what is wrong with one can be said with its
/// place.
class ConfigFile {
 public:
  /// Looks through the file that a command line names with --config, if it does; its keys are to be
  /// options of `app` without their dashes. Errors: kIo (cannot be read), kInvalidArgument (is no
  /// TOML, or has another key), with the line.
  [[nodiscard]] static Result<ConfigFile> read(
      const CLI::App& app,
      std::span<const char* const> arguments);

  /// A complaint about an option, with its place in front if it has its value from the file.
  [[nodiscard]] std::string withPlace(const std::string& complaint) const;

 private:
  std::string file_;
  std::map<std::string, std::size_t> lines_;  // by "--option"
};

}  // namespace limn
