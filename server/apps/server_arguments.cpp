// SPDX-License-Identifier: Apache-2.0
#include "server/apps/server_arguments.h"

#include "server/apps/arguments.h"
#include "server/apps/config_file.h"
#include "server/transport/access.h"

#include "protocol/limits.h"

#include "shared/core/exit_status.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace limn {
namespace {

constexpr char kProgram[] = "limn-server";

constexpr char kExamples[] =
    "Examples:\n"
    "  limn-server --store assets --models meshes\n"
    "  limn-server --store assets --listen 0.0.0.0:8600 --token-file tokens.txt\n"
    "  limn-server --store assets --listen 127.0.0.1:0 --metrics-listen 127.0.0.1:9600\n"
    "  limn-server token --key-file keys --models 'dragon,team-*'   (a token; has a --help of its "
    "own)\n"
    "  limn-server inspect dragon --store assets     (where the bytes go; has a --help of its own)";

Result<std::string> readText(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(ErrorCode::kIo, "cannot read " + path);
  return std::string{std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

Result<TransportOptions> transportOptions(const ServerArguments& arguments) {
  TransportOptions options;
  const auto listen = parseListenAddress(arguments.listen);
  if (!listen) return tl::unexpected(listen.error().within("--listen"));
  options.listen = *listen;
  if (!arguments.metricsListen.empty()) {
    const auto metrics = parseListenAddress(arguments.metricsListen);
    if (!metrics) return tl::unexpected(metrics.error().within("--metrics-listen"));
    options.metricsListen = *metrics;
  }
  if (arguments.tlsCertificate.empty() != arguments.tlsKey.empty()) {
    return fail(ErrorCode::kInvalidArgument, "--tls-cert and --tls-key go together; give both");
  }
  for (const std::string& file : {arguments.tlsCertificate, arguments.tlsKey}) {
    if (file.empty()) continue;
    if (const auto readable = readText(file); !readable) return tl::unexpected(readable.error());
  }
  options.tlsCertificate = arguments.tlsCertificate;
  options.tlsKey = arguments.tlsKey;
  if (!arguments.tokenFile.empty()) {
    const auto text = readText(arguments.tokenFile);
    if (!text) return tl::unexpected(text.error());
    auto tokens = parseTokens(*text);
    if (!tokens) return tl::unexpected(tokens.error().within("--token-file"));
    options.access.tokens = std::move(*tokens);
  }
  if (!arguments.tokenKeyFile.empty()) {
    const auto text = readText(arguments.tokenKeyFile);
    if (!text) return tl::unexpected(text.error());
    auto keys = parseTokenKeys(*text);
    if (!keys) return tl::unexpected(keys.error().within("--token-key-file"));
    options.access.keys = std::move(*keys);
  }
  options.access.origins = arguments.origins;
  options.limits.maxClients = arguments.maxClients;
  options.limits.maxClientsPerAddress = arguments.maxClientsPerAddress;
  options.limits.handshakeMs = arguments.handshakeMs;
  options.limits.maxMessageBytes = arguments.maxMessageBytes;
  options.limits.messagesPerSecond = arguments.messagesPerSecond;
  options.limits.progressMs = arguments.progressMs;
  options.drainMs = arguments.drainMs;
  return options;
}

std::variant<ServerArguments, int> parseServerArguments(int argc, char** argv) {
  ServerArguments arguments;
  CLI::App app("Serves prepared meshes as silhouette-first streams.", kProgram);
  app.set_version_flag("--version", std::string("limn-server ") + LIMN_VERSION);
  app.footer(kExamples);
  app.add_option("--store", arguments.store, "Directory of prepared assets; made when missing")
      ->required();
  app.add_option("--models", arguments.models, "Folder of mesh files to prepare in the background");
  app.add_option("--listen", arguments.listen, "Address for WebSocket and HTTP; port 0: a free one")
      ->capture_default_str();
  app.add_option("--metrics-listen", arguments.metricsListen, "Address for Prometheus' /metrics");
  app.add_option("--tls-cert", arguments.tlsCertificate, "PEM certificate chain");
  app.add_option("--tls-key", arguments.tlsKey, "PEM private key");
  app.add_option(
      "--token-file",
      arguments.tokenFile,
      "Bearer tokens that clients may connect with, one a line");
  app.add_option(
      "--token-key-file",
      arguments.tokenKeyFile,
      "Keys that sign tokens with rights and an expiry (limn-server token), one a line");
  app.add_option("--origin", arguments.origins, "Hosts whose browser pages may connect");
  app.add_option("--max-clients", arguments.maxClients, "Connections at most")
      ->capture_default_str();
  app.add_option(
         "--max-clients-per-address",
         arguments.maxClientsPerAddress,
         "Connections from one address at most; 0: no limit")
      ->capture_default_str();
  app.add_option(
         "--handshake-ms",
         arguments.handshakeMs,
         "Time from a connection to its request and Hello")
      ->check(CLI::Range(100, 600'000))
      ->capture_default_str();
  app.add_option(
         "--max-message-bytes",
         arguments.maxMessageBytes,
         "Size of a client's message at most")
      ->check(CLI::Range(std::size_t{1024}, limits::kMaxClientMessageBytes))
      ->capture_default_str();
  app.add_option(
         "--messages-per-second",
         arguments.messagesPerSecond,
         "Messages from a client at most, besides one for each KiB sent to it")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option(
         "--poses-per-second",
         arguments.posesPerSecond,
         "Poses of a model that count; of more than that the newest do")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--window-kib", arguments.windowKib, "Unacknowledged payload to a client at most")
      ->check(CLI::Range(16, 64 * 1024))
      ->capture_default_str();
  app.add_option(
         "--progress-ms",
         arguments.progressMs,
         "A client that takes or acknowledges nothing for so long is let go")
      ->check(CLI::Range(100, 3'600'000))
      ->capture_default_str();
  app.add_option(
         "--prefetch-after-ms",
         arguments.prefetchAfterMs,
         "A settled pose this old gets everything else too; -1: never")
      ->capture_default_str();
  app.add_option("--drain-ms", arguments.drainMs, "Time for clients to leave after SIGTERM")
      ->capture_default_str();
  app.add_option("--workers", arguments.workers, "Threads that choose splits (default: cores - 1)");
  app.add_option(
         "--target-cache-mib",
         arguments.targetCacheMib,
         "Memory for target sets of view cells")
      ->capture_default_str();
  app.add_option(
      "--random-order",
      arguments.randomOrder,
      "Test mode: splits in random legal order, by seed");
  app.add_option("--log-format", arguments.logFormat, "Lines for people, or JSON objects")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  app.add_option(
         "--prepare-memory-mib",
         arguments.prepareMemoryMib,
         "Address space of a preparation of --models; 0: no limit")
      ->capture_default_str();
  app.add_option(
         "--prepare-cpu-s",
         arguments.prepareCpuS,
         "Processor time of a preparation of --models; 0: no limit")
      ->capture_default_str();
  app.set_config("--config", "", "Read options from a TOML file");
  const auto config = ConfigFile::read(app, {argv, static_cast<std::size_t>(argc)});
  if (!config) return complain(kProgram, kExitUsage, config.error().message);
  const auto explain = [&](const std::string& complaint) { return config->withPlace(complaint); };
  if (const auto status = parseArguments(app, argc, argv, explain)) return *status;
  if (arguments.store.find("://") != std::string::npos) {
    return complain(
        kProgram,
        kExitUsage,
        "--store takes a directory; object stores are not part of this release");
  }
  if (!arguments.models.empty() && !std::filesystem::is_directory(arguments.models)) {
    return complain(
        kProgram,
        kExitUsage,
        "--models " + arguments.models + " is no directory; give a folder of meshes");
  }
  return arguments;
}

}  // namespace limn
