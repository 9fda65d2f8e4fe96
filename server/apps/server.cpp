// SPDX-License-Identifier: Apache-2.0
#include "server/apps/arguments.h"
#include "server/apps/background_preparation.h"
#include "server/apps/inspect.h"
#include "server/apps/log.h"
#include "server/apps/service_manager.h"
#include "server/apps/token.h"
#include "server/session/model_library.h"
#include "server/session/session.h"
#include "server/session/view_cells.h"
#include "server/store/asset_store.h"
#include "server/transport/access.h"
#include "server/transport/lws_setup.h"
#include "server/transport/lws_transport.h"
#include "server/transport/worker_pool.h"

#include "shared/codec/allocation_budget.h"
#include "shared/core/exit_status.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string_view>
#include <thread>

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

struct Arguments {
  std::string store;
  std::string models;
  std::string listen = "127.0.0.1:8600";
  std::string metricsListen;
  std::string tlsCertificate;
  std::string tlsKey;
  std::string tokenFile;
  std::string tokenKeyFile;
  std::vector<std::string> origins;
  std::size_t maxClients = 10'000;
  std::size_t maxClientsPerAddress = TransportLimits{}.maxClientsPerAddress;
  std::int64_t handshakeMs = TransportLimits{}.handshakeMs;
  std::size_t maxMessageBytes = TransportLimits{}.maxMessageBytes;
  std::uint32_t messagesPerSecond = TransportLimits{}.messagesPerSecond;
  double posesPerSecond = SessionOptions{}.posesPerSecond;
  std::uint64_t windowKib = SessionOptions{}.windowBytes / 1024;
  std::int64_t progressMs = TransportLimits{}.progressMs;
  std::int64_t prefetchAfterMs = 1000;
  std::int64_t drainMs = 20'000;
  std::size_t workers = 0;
  std::size_t targetCacheMib = 256;
  std::int64_t randomOrder = -1;
  std::string logFormat = "text";
  // Sanitizers reserve more address space than any limit.
  std::uint64_t prepareMemoryMib =
      AllocationBudget::works() ? PrepareLimits{}.memoryBytes >> 20 : 0;
  std::uint64_t prepareCpuS = PrepareLimits{}.cpuSeconds;
};

/// limn-prepare, where it is installed: beside this program.
std::filesystem::path preparePath() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return self.parent_path() / "limn-prepare";
}

Result<std::string> readText(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(ErrorCode::kIo, "cannot read " + path);
  return std::string{std::istreambuf_iterator<char>(in), {}};
}

void logTransport(const TransportEvent& event) {
  nlohmann::json fields = {{"address", event.address}};
  if (event.connection != 0) fields["connection"] = event.connection;
  if (!event.subject.empty()) fields["subject"] = event.subject;
  switch (event.kind) {
    case TransportEvent::Kind::kOpened:
      return logEvent(spdlog::level::info, "connection_opened", "a client came", fields);
    case TransportEvent::Kind::kClosed:
      fields["reason"] = event.why;
      fields["seconds"] = event.seconds;
      fields["payload_bytes"] = event.payloadBytes;
      return logEvent(spdlog::level::info, "connection_closed", "a client went", fields);
    case TransportEvent::Kind::kRefused:
      fields["reason"] = event.why;
      return logEvent(spdlog::level::warn, "connection_refused", "a client was refused", fields);
  }
}

Result<TransportOptions> transportOptions(const Arguments& arguments) {
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

int serve(const Arguments& arguments, const TransportOptions& options) {
  const auto store = openDirectoryStore(arguments.store);
  if (!store) return complain(kProgram, kExitFailed, store.error().message);
  const bool watches = !arguments.models.empty();
  std::error_code error;
  if (watches && !std::filesystem::exists(preparePath(), error)) {
    return complain(
        kProgram,
        kExitFailed,
        preparePath().string() + " is missing; --models needs it beside limn-server");
  }

  const auto log = [](const PreparationNote& note) {
    nlohmann::json fields = nlohmann::json::object();
    if (!note.model.empty()) fields["model"] = note.model;
    if (note.job != 0) fields["job"] = note.job;
    logEvent(spdlog::level::info, "preparation", note.message, fields);
  };
  setTransportLog([](const std::string& line) { logEvent(spdlog::level::warn, "network", line); });

  // Workers outlive neither what they compute with nor what they wake.
  LwsTransport* wakened = nullptr;
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  std::unique_ptr<LwsTransport> transport;
  WorkerPool workers(
      // Two at least: one searches, one is there for what is urgent.
      arguments.workers != 0 ? arguments.workers : std::max<std::size_t>(2, cores - 1),
      [&wakened] {
        if (wakened != nullptr) wakened->wake();
      });
  BackgroundPreparation* background = nullptr;
  ModelLibrary library(
      **store,
      workers,
      {},
      [&background](const std::string& name, const Sha256Digest& asset, const Error& why) {
        if (background != nullptr) background->damaged(name, asset, why);
      });
  ViewCells cells(workers, {.cacheBytes = arguments.targetCacheMib << 20});
  SessionOptions sessionOptions;
  sessionOptions.prefetchAfterMs = arguments.prefetchAfterMs;
  sessionOptions.posesPerSecond = arguments.posesPerSecond;
  sessionOptions.windowBytes = arguments.windowKib * 1024;
  if (arguments.randomOrder >= 0) {
    sessionOptions.randomSeed = static_cast<std::uint64_t>(arguments.randomOrder);
  }
  SessionShared shared{library, cells, sessionOptions, std::string("limn-server ") + LIMN_VERSION};
  BackgroundOptions backgroundOptions;
  backgroundOptions.store = arguments.store;
  backgroundOptions.models = arguments.models;
  backgroundOptions.prepare = preparePath();
  backgroundOptions.limits = {arguments.prepareMemoryMib << 20, arguments.prepareCpuS};
  BackgroundPreparation preparation(**store, library, backgroundOptions, log);
  background = &preparation;

  TransportHandlers handlers;
  handlers.catalogue = [&library]() -> const std::vector<CatalogueItem>& {
    return library.catalogue();
  };
  ServiceManager manager;
  handlers.tick = [&](std::int64_t nowMs) {
    preparation.tick(nowMs);
    manager.tick(nowMs);
  };
  handlers.woken = [&] { workers.runDone(); };
  handlers.happened = logTransport;
  handlers.status = [&] {
    ServerStatus status;
    status.version = LIMN_VERSION;
    if (!preparation.folderProblem().empty()) {
      status.ready = false;
      status.notReadyBecause = preparation.folderProblem();
    }
    status.modelsLoaded = library.loadedModels();
    status.modelBytes = library.loadedBytes();
    status.targetCacheBytes = cells.cachedBytes();
    status.targetSetsComputedTotal = cells.computed();
    status.targetCacheHitsTotal = cells.hits();
    status.tasksPending = workers.pending();
    status.preparationsTotal = preparation.finished();
    status.preparationsFailedTotal = preparation.failed();
    return status;
  };

  // Whatever way this ends: no work goes on while what it works on goes away.
  struct End {
    WorkerPool& workers;
    std::unique_ptr<LwsTransport>& transport;

    ~End() {
      workers.stop();
      transport.reset();
    }
  };

  const End end{workers, transport};
  auto opened = LwsTransport::open(options, shared, handlers);
  if (!opened) return complain(kProgram, kExitFailed, opened.error().message);
  transport = std::move(*opened);
  wakened = transport.get();
  if (const auto begun = preparation.begin(LwsTransport::nowMs()); !begun) {
    return complain(kProgram, kExitFailed, begun.error().message);
  }

  const std::string scheme = options.tlsCertificate.empty() ? "ws" : "wss";
  const std::string host = options.listen.ipv6           ? "[" + options.listen.host + "]"
                           : options.listen.host.empty() ? "0.0.0.0"
                                                         : options.listen.host;
  std::cout << "limn-server: listening on " << scheme << "://" << host << ':' << transport->port()
            << std::endl;
  if (transport->metricsPort() != 0) {
    std::cout << "limn-server: metrics on http://" << options.metricsListen->host << ':'
              << transport->metricsPort() << "/metrics" << std::endl;
  }
  const bool local = options.listen.host == "::1" || options.listen.host.starts_with("127.");
  if (options.access.guarded() && options.tlsCertificate.empty() && !local) {
    logEvent(
        spdlog::level::warn,
        "unencrypted",
        "tokens travel unencrypted: give --tls-cert and --tls-key, or have a proxy do TLS");
  }
  manager.ready("listening on port " + std::to_string(transport->port()));
  transport->run();
  preparation.stop();
  logEvent(spdlog::level::info, "drained", "drained");
  return kExitSuccess;
}

int run(int argc, char** argv) {
  Arguments arguments;
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
  if (const auto status = parseArguments(app, argc, argv)) return *status;
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
  const auto options = transportOptions(arguments);
  if (!options) return complain(kProgram, kExitUsage, options.error().message);
  // A client that is gone must not end the server.
  std::signal(SIGPIPE, SIG_IGN);
  startLog(arguments.logFormat == "json" ? LogFormat::kJson : LogFormat::kText);
  return serve(arguments, *options);
}

}  // namespace
}  // namespace limn

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "inspect") {
    return limn::inspectCommand(argc - 1, argv + 1);
  }
  if (argc > 1 && std::string_view(argv[1]) == "token") {
    return limn::tokenCommand(argc - 1, argv + 1);
  }
  return limn::run(argc, argv);
}
