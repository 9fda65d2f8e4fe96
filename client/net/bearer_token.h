// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libwebsockets.h>

#include <cstddef>
#include <string>

namespace limn {

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
