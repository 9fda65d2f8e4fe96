// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/connection.h"
#include "client/net/server_url.h"

#include <memory>
#include <string>

namespace limn {

struct LwsConnectionOptions {
  ServerUrl url;
  std::string token;   // sent as `Authorization: Bearer` on the upgrade; empty: none
  std::string caFile;  // PEM certificates to trust for wss besides the system's; empty: none
};

/// A WebSocket to a server, subprotocol `limn.1`, no compression. Its network thread owns the
/// libwebsockets context; only lws_cancel_service() crosses threads, and each writeable callback
/// writes one message.
[[nodiscard]] std::unique_ptr<Connection> makeLwsConnection(LwsConnectionOptions options);

}  // namespace limn
