// SPDX-License-Identifier: Apache-2.0
// limn-load: many light clients against one server, in one process, from a script.
#include "client/apps/load_run.h"
#include "client/apps/load_server_usage.h"
#include "client/apps/token.h"
#include "client/load/mesh_decoder.h"
#include "client/load/report.h"
#include "client/load/script.h"

#include "shared/core/exit_status.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>

namespace {

constexpr char kExamples[] = R"(Examples:
  limn-load --server ws://127.0.0.1:8600 --script tests/load/orbit.toml
  limn-load --server wss://host:443 --token-file token --script mix.toml --report load.json

The report goes to stdout unless --report names a file. Exit status: 0 when every threshold of the script
holds, 1 when one is missed or nothing could be done, 2 on wrong usage.)";

struct Arguments {
  std::string server;
  std::string script;
  std::string report;
  std::string tokenFile;
  std::string caFile;
  int serverPid = 0;
};

int complain(int status, const std::string& message) {
  std::cerr << "limn-load: " << message << "\n";
  return status;
}

/// The port of a URL on this machine, where its server process can be watched.
std::optional<int> localPort(const std::string& url) {
  const auto scheme = url.find("://");
  if (scheme == std::string::npos) return std::nullopt;
  const std::string rest = url.substr(scheme + 3);
  for (const char* host : {"127.0.0.1:", "localhost:", "[::1]:"}) {
    if (rest.starts_with(host)) return std::atoi(rest.c_str() + std::string(host).size());
  }
  return std::nullopt;
}

int run(const Arguments& arguments) {
  const auto script = limn::load::readScript(arguments.script);
  if (!script) return complain(limn::exitStatusOf(script.error()), script.error().message);
  limn::load::RunOptions options;
  options.url = arguments.server;
  options.makeDecoder = limn::load::makeMeshDecoder;
  auto token = limn::readToken(arguments.tokenFile);
  if (!token) return complain(limn::kExitFailed, token.error().message);
  options.token = std::move(*token);
  options.caFile = arguments.caFile;
  if (arguments.serverPid > 0) {
    options.server = arguments.serverPid;
  } else if (const auto port = localPort(arguments.server)) {
    options.server = limn::load::findListener(*port);
  }
  options.progress = [](double seconds, const limn::load::Counters& counters) {
    std::fprintf(
        stderr,
        "limn-load: %.0f s: %llu of %llu clients, %llu failed, %llu dropped, %.1f MB\n",
        seconds,
        static_cast<unsigned long long>(counters.connected),
        static_cast<unsigned long long>(counters.asked),
        static_cast<unsigned long long>(counters.failed),
        static_cast<unsigned long long>(counters.dropped),
        static_cast<double>(counters.bytesReceived) / 1e6);
  };
  const auto result = limn::load::runScript(*script, options);
  if (!result) return complain(limn::exitStatusOf(result.error()), result.error().message);
  auto missed = limn::load::missedThresholds(script->thresholds, result->counters, result->server);
  if (result->counters.connected == 0) {
    std::string message = "no client reached the base mesh";
    if (!result->counters.errors.empty()) message += ": " + result->counters.errors.begin()->first;
    missed.push_back(message);
  }
  const std::string report = limn::load::reportJson(*result, missed);
  if (arguments.report.empty()) {
    std::cout << report << "\n";
  } else {
    std::ofstream stream(arguments.report);
    stream << report << "\n";
    if (!stream.flush()) {
      return complain(limn::kExitFailed, arguments.report + ": cannot be written; check the path");
    }
  }
  for (const std::string& miss : missed)
    complain(limn::kExitFailed, miss);
  return missed.empty() ? limn::kExitSuccess : limn::kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Load-tests a Limn server with many light clients.", "limn-load");
  app.set_version_flag("--version", std::string("limn-load " LIMN_VERSION));
  app.footer(kExamples);
  Arguments arguments;
  app.add_option("--server", arguments.server, "ws://HOST:PORT or wss://HOST:PORT")->required();
  app.add_option("--script", arguments.script, "what the clients do, TOML")->required();
  app.add_option("--report", arguments.report, "write the JSON report here instead of to stdout");
  app.add_option(
      "--token-file",
      arguments.tokenFile,
      "file with the server's token (default: $LIMN_TOKEN)");
  app.add_option("--ca-file", arguments.caFile, "certificates (PEM) to trust for wss://");
  app.add_option(
      "--server-pid",
      arguments.serverPid,
      "server process on this machine to watch; found by its port when it is local");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return complain(limn::kExitUsage, std::string(error.what()) + "; see limn-load --help");
  }
  return run(arguments);
}
