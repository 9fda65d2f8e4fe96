// SPDX-License-Identifier: Apache-2.0
#include "server/transport/lws_setup.h"

#include <libwebsockets.h>
#include <sys/resource.h>

#include <algorithm>
#include <utility>

namespace limn {
namespace {

constexpr std::size_t kMaxHeaderBytes = 4 * 1024;  // of a request

// Connections ping by themselves: the library sorts its timers into a list from its front, so that
// each of 15,000 would be passed for every one that is set.
const lws_retry_bo_t kNoPings = {nullptr, 0, 0, 0, 0, 0};

std::function<void(const std::string&)>& logSink() {
  static std::function<void(const std::string&)> sink;
  return sink;
}

void logLine(int, const char* line) {
  std::string text(line);
  while (text.ends_with('\n'))
    text.pop_back();
  logTransport(text);
}

}  // namespace

void setTransportLog(std::function<void(const std::string&)> sink) {
  logSink() = std::move(sink);
}

void logTransport(const std::string& line) {
  if (logSink()) logSink()(line);
}

std::size_t raiseFileLimit() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < files.rlim_max) {
    files.rlim_cur = files.rlim_max;
    static_cast<void>(setrlimit(RLIMIT_NOFILE, &files));
  }
  return files.rlim_cur > 0 ? static_cast<std::size_t>(files.rlim_cur) : 1024;
}

lws_context* makeContext(struct ev_loop* loop, void* user, std::size_t mostFiles) {
  lws_set_log_level(LLL_ERR | LLL_WARN, logLine);
  lws_context_creation_info info{};
  void* loops[] = {loop};
  info.foreign_loops = loops;
  info.user = user;
  info.options = LWS_SERVER_OPTION_LIBEV | LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
                 LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
  info.max_http_header_data = kMaxHeaderBytes;
  info.fd_limit_per_thread = static_cast<unsigned>(std::min<std::size_t>(mostFiles, 1U << 20));
  info.pt_serv_buf_size = static_cast<unsigned>(kTxPacketBytes);
  info.retry_and_idle_policy = &kNoPings;
  return lws_create_context(&info);
}

Result<lws_vhost*> openPort(lws_context* context, const PortOptions& options) {
  const ListenAddress& address = options.address;
  lws_context_creation_info info{};
  info.port = address.port;
  info.iface = address.host.empty() || address.host == "0.0.0.0" ? nullptr : address.host.c_str();
  if (address.ipv6 && address.host == "::") info.iface = nullptr;
  info.vhost_name = options.name;
  info.protocols = options.protocols;
  // Ours comes first; this one is for what never becomes a socket of ours (TLS handshakes).
  info.timeout_secs = static_cast<unsigned>(options.handshakeMs / 1000 + 1);
  info.keepalive_timeout = 15;
  info.retry_and_idle_policy = &kNoPings;
  if (!address.ipv6) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  info.alpn = "http/1.1";
  if (options.tlsCertificate != nullptr) {
    info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    info.ssl_cert_filepath = options.tlsCertificate;
    info.ssl_private_key_filepath = options.tlsKey;
  }
  lws_vhost* vhost = lws_create_vhost(context, &info);
  // A port that is taken leaves a vhost behind that does not listen.
  if (vhost == nullptr || lws_get_vhost_listen_port(vhost) <= 0) {
    const std::string where = (address.ipv6 ? "[" + address.host + "]" : address.host) + ":" +
                              std::to_string(address.port);
    return fail(
        ErrorCode::kIo,
        "cannot listen on " + where +
            "; is the port taken, the address one of this machine's, and are the TLS files right?");
  }
  return vhost;
}

}  // namespace limn
