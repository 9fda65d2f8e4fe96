// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/net/lws_connection.h"

#include "shared/core/result.h"

#include <cstddef>
#include <string>

namespace limn {

/// GETs `path` from a server's port over HTTP, or HTTPS where the URL is wss. Blocks, at most about
/// ten seconds. Errors: kNetwork (nobody there, another status than 200, too slow); kLimitExceeded
/// (an answer longer than maxBytes). Threads: any, each call its own.
[[nodiscard]] Result<std::string>
httpGet(const LwsConnectionOptions& server, const std::string& path, std::size_t maxBytes);

}  // namespace limn
