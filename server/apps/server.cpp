// SPDX-License-Identifier: Apache-2.0
#include "server/apps/arguments.h"
#include "server/apps/background_preparation.h"
#include "server/apps/inspect.h"
#include "server/apps/log.h"
#include "server/apps/server_arguments.h"
#include "server/apps/service_manager.h"
#include "server/apps/token.h"
#include "server/session/model_library.h"
#include "server/session/session.h"
#include "server/session/view_cells.h"
#include "server/store/asset_store.h"
#include "server/transport/lws_setup.h"
#include "server/transport/lws_transport.h"
#include "server/transport/worker_pool.h"

#include "shared/core/exit_status.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <iostream>
#include <string_view>
#include <thread>
#include <variant>

namespace limn {
namespace {

constexpr char kProgram[] = "limn-server";

/// limn-prepare, where it is installed: beside this program.
std::filesystem::path preparePath() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return self.parent_path() / "limn-prepare";
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

int serve(const ServerArguments& arguments, const TransportOptions& options) {
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
  const auto parsed = parseServerArguments(argc, argv);
  if (const int* status = std::get_if<int>(&parsed)) return *status;
  const auto& arguments = std::get<ServerArguments>(parsed);
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
