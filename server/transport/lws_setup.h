// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/transport/access.h"

#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

struct ev_loop;
struct lws_context;
struct lws_protocols;
struct lws_vhost;

namespace limn {

/// Of a socket's receive buffer, and of what is written at once.
inline constexpr std::size_t kRxBufferBytes = 4 * 1024;
inline constexpr std::size_t kTxPacketBytes = 64 * 1024;

/// Sends the library's own messages somewhere; they are lines without newline. Call first.
void setTransportLog(std::function<void(const std::string&)> sink);

/// Says a line there.
void logTransport(const std::string& line);

/// Raises the limit of open files as far as it goes; how many there may be then.
[[nodiscard]] std::size_t raiseFileLimit();

/// A context of the library on a loop of ours, without ports; nullptr if there can be none.
/// user: what lws_context_user() then says.
[[nodiscard]] lws_context* makeContext(struct ev_loop* loop, void* user, std::size_t mostFiles);

/// A port of a context, which what this names must outlive.
struct PortOptions {
  const ListenAddress& address;
  const char* name = "";
  const lws_protocols* protocols = nullptr;
  std::int64_t handshakeMs = 0;          // the longest that a TLS handshake may take
  const char* tlsCertificate = nullptr;  // PEM files; both or none
  const char* tlsKey = nullptr;
};

/// Errors: kIo (taken, not ours, bad certificate), with what to do.
[[nodiscard]] Result<lws_vhost*> openPort(lws_context* context, const PortOptions& options);

}  // namespace limn
