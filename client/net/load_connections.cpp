// SPDX-License-Identifier: Apache-2.0
#include "client/net/load_connections.h"

#include "client/net/lws_client.h"
#include "client/net/server_url.h"

#include <ev.h>
#include <libwebsockets.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <unordered_map>
#include <utility>

namespace limn {
namespace {

constexpr std::size_t kMostFiles = std::size_t{1} << 20;
// No timers a connection: the library sorts them into a list from its front.
const lws_retry_bo_t kNoPings = {nullptr, 0, 0, 0, 0, 0};

/// Raises the limit of open files as far as it goes; what it is then. The library's table of
/// sockets must be of that very size: it would search a smaller one from end to end for every
/// event.
std::size_t mostOpenFiles() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 0;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, kMostFiles);
  return setrlimit(RLIMIT_NOFILE, &limit) == 0 ? static_cast<std::size_t>(limit.rlim_cur) : 0;
}

}  // namespace

struct LoadConnections::Impl {
  struct Connection {
    Id id = 0;
    lws* wsi = nullptr;
    // Each message with LWS_PRE bytes in front, as lws_write() wants it.
    std::deque<std::vector<std::uint8_t>> outgoing;
    std::vector<std::uint8_t> incoming;
    std::string reason = "the server closed the connection";
    bool open = false;
    bool closing = false;
    bool aborted = false;
  };

  Options options;
  ServerUrl address;
  Listener* listener = nullptr;
  lws_context* context = nullptr;

  struct ev_loop* loop = ev_loop_new(EVFLAG_AUTO);
  ev_timer timer{};

  Id nextId = 0;
  std::unordered_map<Id, std::unique_ptr<Connection>> connections;
  bool connecting = false;                            // within connect()
  std::vector<std::pair<Id, std::string>> stillborn;  // failed within connect(), not yet told

  ~Impl() {
    // Destroying the context closes what is open; nobody is to hear of it any more.
    listener = nullptr;
    if (context != nullptr) lws_context_destroy(context);
    // The library closes what it had on a loop of ours only while that loop runs.
    ev_run(loop, EVRUN_NOWAIT);
    ev_loop_destroy(loop);
  }

  Connection* find(Id id) {
    const auto found = connections.find(id);
    return found == connections.end() ? nullptr : found->second.get();
  }

  void gone(Connection& connection, lws* wsi) {
    const Id id = connection.id;
    std::string reason = std::move(connection.reason);
    if (wsi != nullptr) lws_set_opaque_user_data(wsi, nullptr);
    connections.erase(id);
    if (connecting) {
      // The caller of connect() does not know the id yet.
      stillborn.emplace_back(id, std::move(reason));
    } else if (listener != nullptr) {
      listener->closed(id, reason);
    }
  }

  /// Returns what the libwebsockets callback returns: nonzero closes the connection.
  int writeNext(Connection& connection) {
    if (connection.aborted) return -1;
    if (connection.outgoing.empty()) {
      if (!connection.closing) return 0;
      lws_close_reason(connection.wsi, LWS_CLOSE_STATUS_NORMAL, nullptr, 0);
      return -1;
    }
    std::vector<std::uint8_t> message = std::move(connection.outgoing.front());
    connection.outgoing.pop_front();
    const std::size_t length = message.size() - LWS_PRE;
    if (lws_write(connection.wsi, message.data() + LWS_PRE, length, LWS_WRITE_BINARY) <
        static_cast<int>(length)) {
      connection.reason = "the connection broke while sending";
      return -1;
    }
    if (!connection.outgoing.empty() || connection.closing) {
      lws_callback_on_writable(connection.wsi);
    }
    return 0;
  }

  int read(Connection& connection, const std::uint8_t* bytes, std::size_t length) {
    lws* wsi = connection.wsi;
    if (connection.incoming.size() + length > options.maxMessageBytes) {
      connection.reason = "a message longer than the protocol allows";
      return -1;
    }
    connection.incoming.insert(connection.incoming.end(), bytes, bytes + length);
    if (lws_is_final_fragment(wsi) == 0 || lws_remaining_packet_payload(wsi) != 0) return 0;
    if (lws_frame_is_binary(wsi) == 0) {
      connection.reason = "a text frame, which the protocol does not have";
      return -1;
    }
    const std::vector<std::uint8_t> message = std::exchange(connection.incoming, {});
    if (listener != nullptr) listener->received(connection.id, message);
    return 0;
  }

  int callback(lws* wsi, lws_callback_reasons reason, void* in, std::size_t length) {
    auto* connection = static_cast<Connection*>(lws_get_opaque_user_data(wsi));
    if (connection == nullptr) return 0;
    switch (reason) {
      case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER:
        return addBearerToken(wsi, options.token, in, length);
      case LWS_CALLBACK_CLIENT_ESTABLISHED:
        connection->wsi = wsi;
        connection->open = true;
        if (listener != nullptr) listener->opened(connection->id);
        return 0;
      case LWS_CALLBACK_CLIENT_RECEIVE:
        return read(*connection, static_cast<const std::uint8_t*>(in), length);
      case LWS_CALLBACK_CLIENT_WRITEABLE:
        return writeNext(*connection);
      case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
        connection->reason =
            "cannot connect: " +
            (in != nullptr ? std::string(static_cast<const char*>(in)) : std::string("no answer"));
        gone(*connection, wsi);
        return 0;
      case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
        if (length >= 2) {
          const auto* bytes = static_cast<const unsigned char*>(in);
          connection->reason =
              "the server closed with status " + std::to_string(bytes[0] * 256 + bytes[1]);
        }
        return 0;
      case LWS_CALLBACK_WSI_DESTROY:  // all there is when a handshake takes too long
        if (!connection->open && !connection->aborted)
          connection->reason = "cannot connect: no answer";
        [[fallthrough]];
      case LWS_CALLBACK_CLIENT_CLOSED:
        gone(*connection, wsi);
        return 0;
      default:
        return 0;
    }
  }

  static int
  lwsCallback(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* in, std::size_t length) {
    auto* self =
        wsi != nullptr ? static_cast<Impl*>(lws_context_user(lws_get_context(wsi))) : nullptr;
    return self != nullptr ? self->callback(wsi, reason, in, length) : 0;
  }
};

LoadConnections::LoadConnections(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

LoadConnections::~LoadConnections() = default;

Result<std::unique_ptr<LoadConnections>> LoadConnections::create(
    Options options,
    Listener& listener) {
  auto address = parseServerUrl(options.url);
  if (!address) return tl::unexpected(address.error());
  const std::size_t needed = options.maxConnections + 64;
  const std::size_t files = mostOpenFiles();
  if (files < needed) {
    return fail(
        ErrorCode::kUnavailable,
        "this process may not open " + std::to_string(needed) +
            " files; raise the limit (ulimit -n) or ask for fewer clients");
  }
  auto impl = std::make_unique<Impl>();
  impl->options = std::move(options);
  impl->address = std::move(*address);
  impl->listener = &listener;

  lws_set_log_level(0, nullptr);
  // Static: libwebsockets keeps the pointer. rx_buffer_size also caps a single read.
  static std::array<lws_protocols, 2> protocols{};
  protocols[0].name = "limn-load";
  protocols[0].callback = &Impl::lwsCallback;
  protocols[0].rx_buffer_size = 64 * 1024;
  protocols[0].tx_packet_size = 64 * 1024;
  lws_context_creation_info info{};
  info.port = CONTEXT_PORT_NO_LISTEN;
  info.protocols = protocols.data();
  info.user = impl.get();
  info.fd_limit_per_thread = static_cast<unsigned int>(files);
  info.retry_and_idle_policy = &kNoPings;
  void* loops[] = {impl->loop};
  info.foreign_loops = loops;
  info.options = LWS_SERVER_OPTION_LIBEV;
  if (impl->address.tls) {
    info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    if (!impl->options.caFile.empty()) info.client_ssl_ca_filepath = impl->options.caFile.c_str();
  }
  impl->context = lws_create_context(&info);
  if (impl->context == nullptr) {
    return fail(
        ErrorCode::kNetwork,
        "libwebsockets could not start with libev; is libwebsockets-evlib-ev installed?");
  }
  ev_timer_init(
      &impl->timer,
      [](struct ev_loop*, ev_timer*, int) {},
      0.0,
      0.0);
  return std::unique_ptr<LoadConnections>(new LoadConnections(std::move(impl)));
}

LoadConnections::Id LoadConnections::connect() {
  Impl& impl = *impl_;
  auto owned = std::make_unique<Impl::Connection>();
  Impl::Connection& connection = *owned;
  connection.id = impl.nextId++;
  const Id id = connection.id;
  impl.connections.emplace(id, std::move(owned));

  lws_client_connect_info info{};
  info.context = impl.context;
  info.address = impl.address.host.c_str();
  info.host = info.address;
  info.port = impl.address.port;
  info.path = impl.address.path.c_str();
  info.origin = impl.options.origin.empty() ? nullptr : impl.options.origin.c_str();
  info.protocol = impl.options.subprotocol.c_str();
  info.local_protocol_name = "limn-load";
  info.opaque_user_data = &connection;
  info.retry_and_idle_policy = &kNoPings;
  lws* wsi = nullptr;  // not the connection's own: it may be gone before the library writes this
  info.pwsi = &wsi;
  if (impl.address.tls) info.ssl_connection = LCCSCF_USE_SSL;
  impl.connecting = true;
  const bool begun = lws_client_connect_via_info(&info) != nullptr;
  // On failure CLIENT_CONNECTION_ERROR may have come already, or nothing ever will.
  if (Impl::Connection* left = impl.find(id)) {
    left->wsi = wsi;
    if (!begun) {
      left->reason = "cannot connect: refused by the system";
      impl.gone(*left, nullptr);
    }
  }
  impl.connecting = false;
  return id;
}

void LoadConnections::send(Id id, std::vector<std::uint8_t> message) {
  Impl::Connection* connection = impl_->find(id);
  if (connection == nullptr || connection->closing || connection->aborted) return;
  message.insert(message.begin(), LWS_PRE, 0);
  connection->outgoing.push_back(std::move(message));
  if (connection->open) lws_callback_on_writable(connection->wsi);
}

void LoadConnections::close(Id id) {
  Impl::Connection* connection = impl_->find(id);
  if (connection == nullptr) return;
  if (!connection->open) return abort(id);
  connection->closing = true;
  connection->reason = "closed";
  lws_callback_on_writable(connection->wsi);
}

void LoadConnections::abort(Id id) {
  Impl::Connection* connection = impl_->find(id);
  if (connection == nullptr || connection->wsi == nullptr) return;
  connection->aborted = true;
  connection->reason = "cut";
  // Asynchronous: this may be a callback of the very connection.
  lws_set_timeout(connection->wsi, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
  // The library looks at its timers only after events of its own.
  lws_cancel_service(impl_->context);
}

void LoadConnections::pauseReading(Id id) {
  Impl::Connection* connection = impl_->find(id);
  if (connection != nullptr && connection->open) lws_rx_flow_control(connection->wsi, 0);
}

void LoadConnections::resumeReading(Id id) {
  Impl::Connection* connection = impl_->find(id);
  if (connection != nullptr && connection->open) lws_rx_flow_control(connection->wsi, 1);
}

void LoadConnections::service(double timeoutMs) {
  for (const auto& [id, reason] : std::exchange(impl_->stillborn, {})) {
    impl_->listener->closed(id, reason);
  }
  if (timeoutMs <= 0.0) {
    ev_run(impl_->loop, EVRUN_NOWAIT);
    return;
  }
  ev_now_update(impl_->loop);
  ev_timer_set(&impl_->timer, timeoutMs / 1000.0, 0.0);
  ev_timer_start(impl_->loop, &impl_->timer);
  ev_run(impl_->loop, EVRUN_ONCE);
  ev_timer_stop(impl_->loop, &impl_->timer);
}

}  // namespace limn
