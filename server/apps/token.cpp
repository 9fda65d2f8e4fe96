// SPDX-License-Identifier: Apache-2.0
#include "server/apps/token.h"

#include "server/apps/arguments.h"
#include "server/transport/tokens.h"

#include "shared/core/exit_status.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

namespace limn {
namespace {

constexpr char kProgram[] = "limn-server token";

constexpr char kExamples[] =
    "Examples:\n"
    "  limn-server token --new-key main >> keys\n"
    "  limn-server token --key-file keys --models dragon,bunny --minutes 60 > token\n"
    "  limn-client view --server wss://host --token-file token";

struct Arguments {
  std::string newKey;
  std::string keyFile;
  std::string key;
  std::vector<std::string> models;
  std::string subject;
  std::int64_t minutes = 10;
};

int mint(const Arguments& arguments) {
  std::ifstream in(arguments.keyFile, std::ios::binary);
  if (!in) return complain(kProgram, kExitFailed, "cannot read " + arguments.keyFile);
  const auto keys = parseTokenKeys(std::string{std::istreambuf_iterator<char>(in), {}});
  if (!keys)
    return complain(kProgram, kExitFailed, arguments.keyFile + ": " + keys.error().message);
  // The last one is the newest, where keys are added at the end.
  auto key = std::prev(keys->end());
  if (!arguments.key.empty()) {
    key = std::ranges::find(*keys, arguments.key, &TokenKey::id);
    if (key == keys->end()) {
      return complain(
          kProgram,
          kExitFailed,
          arguments.keyFile + " has no key '" + arguments.key + "'");
    }
  }
  TokenClaims claims;
  claims.grant = {arguments.subject, arguments.models};
  claims.expiresS = std::time(nullptr) + 60 * arguments.minutes;
  const std::string token = signToken(claims, *key);
  if (token.size() > kMaxTokenBytes) {
    return complain(
        kProgram,
        kExitFailed,
        "that is " + std::to_string(token.size()) + " bytes, a server takes " +
            std::to_string(kMaxTokenBytes) + ": name fewer models, or NAME* for many");
  }
  std::cout << token << '\n';
  return kExitSuccess;
}

}  // namespace

int tokenCommand(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Prints a token for clients, or a new key to sign tokens with.", kProgram);
  app.footer(kExamples);
  app.add_option("--new-key", arguments.newKey, "Print a new key of this name instead, for a file");
  app.add_option("--key-file", arguments.keyFile, "The server's --token-key-file");
  app.add_option("--key", arguments.key, "Name of the key to sign with (default: the last)");
  app.add_option(
         "--models",
         arguments.models,
         "Models that the token's bearer may see; NAME* for all that begin so, * for all")
      ->delimiter(',');
  app.add_option("--subject", arguments.subject, "Whose token it is, for the server's log");
  app.add_option("--minutes", arguments.minutes, "How long clients may connect with it")
      ->check(CLI::Range(1, 60 * 24 * 366))
      ->capture_default_str();
  if (const auto status = parseArguments(app, argc, argv)) return *status;
  if (!arguments.newKey.empty()) {
    const auto line = makeTokenKey(arguments.newKey);
    if (!line) return complain(kProgram, kExitUsage, line.error().message);
    std::cout << *line << '\n';
    return kExitSuccess;
  }
  if (arguments.keyFile.empty() || arguments.models.empty()) {
    return complain(kProgram, kExitUsage, "give --key-file and --models, or --new-key NAME");
  }
  return mint(arguments);
}

}  // namespace limn
