// SPDX-License-Identifier: Apache-2.0
#include "server/apps/config_file.h"

#include "shared/core/toml_errors.h"

#include <CLI/CLI.hpp>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

namespace limn {
namespace {

/// Whether a word of a command line is an option, alone or with "=VALUE".
bool isOption(std::string_view word, std::string_view option) {
  return word.starts_with(option) && (word.size() == option.size() || word[option.size()] == '=');
}

std::string configNamed(std::span<const char* const> arguments) {
  constexpr std::string_view kFlag = "--config";
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view word = arguments[i];
    if (!isOption(word, kFlag)) continue;
    if (word.size() > kFlag.size()) return std::string(word.substr(kFlag.size() + 1));
    if (i + 1 < arguments.size()) return arguments[i + 1];
  }
  return {};
}

}  // namespace

Result<ConfigFile> ConfigFile::read(const CLI::App& app, std::span<const char* const> arguments) {
  ConfigFile config;
  config.file_ = configNamed(arguments);
  const std::string& file = config.file_;
  if (file.empty()) return config;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail(ErrorCode::kIo, file + ": cannot be read; check the path");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const auto wrong = [&](const std::string& what) {
    return fail(ErrorCode::kInvalidArgument, file + ": " + what);
  };
  toml::table root;
  // Debian's library is built with exceptions, so they are caught here.
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    return wrong(tomlError(error.source().begin.line, error.description()));
  }
  for (const auto& [key, node] : root) {
    const std::string option = "--" + std::string(key.str());
    if (app.get_option_no_throw(option) != nullptr) {
      const bool isSaid = std::ranges::any_of(arguments, [&](std::string_view word) {
        return isOption(word, option);  // which wins
      });
      if (!isSaid) config.lines_[option] = node.source().begin.line;
      continue;
    }
    std::vector<std::string> names;
    for (const CLI::Option* known : app.get_options()) {
      if (known->get_configurable() && !known->get_lnames().empty())
        names.push_back(known->get_lnames().front());
    }
    const std::vector<std::string_view> known(names.begin(), names.end());
    return wrong(unknownTomlKey(node.source().begin.line, key.str(), known));
  }
  return config;
}

std::string ConfigFile::withPlace(const std::string& complaint) const {
  for (const auto& [option, line] : lines_) {
    const std::size_t at = complaint.find(option);
    if (at == std::string::npos) continue;
    // --max-clients is no part of --max-clients-per-address.
    const std::size_t end = at + option.size();
    const bool goesOn =
        end < complaint.size() &&
        (complaint[end] == '-' || std::isalnum(static_cast<unsigned char>(complaint[end])) != 0);
    if (!goesOn) return file_ + ": " + tomlError(line, complaint);
  }
  return complaint;
}

}  // namespace limn
