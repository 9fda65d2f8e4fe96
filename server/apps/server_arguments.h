// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/apps/prepare_process.h"
#include "server/session/channel.h"
#include "server/transport/limits.h"
#include "server/transport/lws_transport.h"

#include "shared/codec/allocation_budget.h"
#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace limn {

/// What limn-server's command line and its file of options say, as they stand there.
struct ServerArguments {
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

/// Parses limn-server's command line. Otherwise the program's exit status: help was printed, or
/// what is wrong was said on stderr.
[[nodiscard]] std::variant<ServerArguments, int> parseServerArguments(int argc, char** argv);

/// Reads the files that they name. Errors: kIo, kInvalidArgument, by flag.
[[nodiscard]] Result<TransportOptions> transportOptions(const ServerArguments& arguments);

}  // namespace limn
