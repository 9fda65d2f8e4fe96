// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/load/light_client.h"
#include "client/load/report.h"
#include "client/load/script.h"

#include "shared/core/result.h"

#include <sys/types.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace limn::load {

struct RunOptions {
  std::string url;
  std::string token;            // empty: none
  std::string caFile;           // PEM certificates to trust besides the system's; empty: none
  std::optional<pid_t> server;  // the process to watch; empty: none
  std::function<std::unique_ptr<PayloadDecoder>()> makeDecoder;
  /// Called about once a second with the time since the start. Empty: silence.
  std::function<void(double seconds, const Counters& counters)> progress;
};

/// Plays a script against a server, in the calling thread, in real time. Errors: what
/// LoadConnections::create() says.
[[nodiscard]] Result<Run> runScript(const Script& script, const RunOptions& options);

}  // namespace limn::load
