// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/net/lws_connection.h"

#include <libwebsockets.h>

#include <cstddef>
#include <string>

namespace limn {

/// What a context needs that connects to one server and listens nowhere. protocols: as
/// libwebsockets takes them, its callbacks find `user` with lws_context_user(). Both, and `server`,
/// must outlive the context.
[[nodiscard]] inline lws_context_creation_info
clientContextInfo(const LwsConnectionOptions& server, const lws_protocols* protocols, void* user) {
  lws_set_log_level(0, nullptr);
  lws_context_creation_info info{};
  info.port = CONTEXT_PORT_NO_LISTEN;
  info.protocols = protocols;
  info.user = user;
  info.pt_serv_buf_size = 8 * 1024;  // a request with a token must fit
  info.fd_limit_per_thread = 16;     // else lws sizes its tables by ulimit -n
  if (server.url.tls) {
    info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    if (!server.caFile.empty()) info.client_ssl_ca_filepath = server.caFile.c_str();
  }
  return info;
}

/// Adds `Authorization: Bearer TOKEN` to a request; to be called in
/// LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER with that callback's arguments, whose result it
/// returns. An empty token adds nothing.
[[nodiscard]] inline int
addBearerToken(lws* wsi, const std::string& token, void* in, std::size_t room) {
  if (token.empty()) return 0;
  const std::string value = "Bearer " + token;
  auto** at = static_cast<unsigned char**>(in);
  unsigned char* end = *at + room;
  const int failed = lws_add_http_header_by_token(
      wsi,
      WSI_TOKEN_HTTP_AUTHORIZATION,
      reinterpret_cast<const unsigned char*>(value.data()),
      static_cast<int>(value.size()),
      at,
      end);
  return failed == 0 ? 0 : -1;
}

}  // namespace limn
