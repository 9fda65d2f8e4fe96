// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/connection.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace limn {

/// One thing that a recorded server did.
struct ReplayStep {
  /// The client's message that must have come before, by its name ("Open"); empty: at once.
  std::string awaits;
  std::vector<std::uint8_t> message;  // said then; empty: nothing
  bool lost = false;                  // and then the connection is lost
};

/// Plays recorded messages, in order, once.
[[nodiscard]] std::unique_ptr<Connection> makeReplayConnection(std::vector<ReplayStep> steps);

}  // namespace limn
