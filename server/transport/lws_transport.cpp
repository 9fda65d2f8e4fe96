// SPDX-License-Identifier: Apache-2.0
//
// The traps of libwebsockets 4.1 that shape this file: without tx_packet_size a send is cut to the
// receive buffer; an IPv4 address binds every interface while IPv6 is on; lws_write() is for the
// writeable callback, once each; partial writes are the library's to finish; lws_cancel_service()
// is the one call for other threads; the descriptor table follows `ulimit -n` unless told; an
// Upgrade to anything but "websocket" is refused (use after free, NN-2025-0102). permessage-deflate
// stays off: packets do not deflate, and it costs 265 KiB a client.
#include "server/transport/lws_transport.h"

#include "protocol/limits.h"

#include <ev.h>
#include <libwebsockets.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <unordered_set>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr double kTickSeconds = 0.05;
constexpr std::size_t kTxPacketBytes = 64 * 1024;
constexpr std::size_t kRxBufferBytes = 4 * 1024;
constexpr std::uint32_t kDrainRetryMs = 500;
constexpr std::uint32_t kDrainSpreadMs = 2000;

std::function<void(const std::string&)>& logSink() {
  static std::function<void(const std::string&)> sink;
  return sink;
}

void logLine(int, const char* line) {
  std::string text(line);
  while (text.ends_with('\n'))
    text.pop_back();
  if (logSink()) logSink()(text);
}

std::string header(lws* wsi, lws_token_indexes token) {
  std::array<char, 1024> buffer{};
  const int length = lws_hdr_copy(wsi, buffer.data(), static_cast<int>(buffer.size()), token);
  return length > 0 ? std::string(buffer.data(), static_cast<std::size_t>(length)) : std::string();
}

std::string addressOf(lws* wsi) {
  std::array<char, 64> buffer{};
  lws_get_peer_simple(wsi, buffer.data(), buffer.size());
  return buffer.data();
}

class Transport;

/// One WebSocket connection.
struct Connection final : public Peer {
  Connection(lws* socket, std::string from, SessionShared& shared, std::int64_t nowMs)
      : wsi(socket),
        address(std::move(from)),
        session(shared, *this, nowMs) {}

  void wantWrite() override { lws_callback_on_writable(wsi); }

  lws* wsi;
  std::string address;
  Session session;
  std::vector<std::uint8_t> partial;  // of a message that came in pieces
};

/// What libwebsockets keeps for a connection.
struct PerSocket {
  Connection* connection;  // WebSocket
  std::string* body;       // HTTP: what is left to send
};

class Transport final : public LwsTransport {
 public:
  Transport(const TransportOptions& options, SessionShared& shared, TransportHandlers handlers)
      : options_(options),
        shared_(shared),
        handlers_(std::move(handlers)) {}

  ~Transport() override {
    if (context_ != nullptr) lws_context_destroy(context_);
    for (ev_signal& watcher : signals_)
      ev_signal_stop(loop_, &watcher);
    ev_timer_stop(loop_, &tick_);
    // The library closes what it had on a loop of ours only while that loop runs.
    ev_run(loop_, EVRUN_NOWAIT);
    ev_loop_destroy(loop_);
  }

  Result<void> start();

  int port() const override { return port_; }

  int metricsPort() const override { return metricsPort_; }

  void run() override { ev_run(loop_, 0); }

  void wake() override { lws_cancel_service(context_); }

  int onWebSocket(
      lws* wsi,
      lws_callback_reasons reason,
      PerSocket* socket,
      void* in,
      std::size_t size);
  int onHttp(lws* wsi, lws_callback_reasons reason, PerSocket* socket, void* in, std::size_t size);

 private:
  Result<lws_vhost*> openVhost(const ListenAddress& address, const char* name);
  int admit(lws* wsi);
  int receive(Connection& connection, const void* in, std::size_t size);
  int write(Connection& connection);
  int answer(lws* wsi, PerSocket& socket, std::string_view path);
  void onTick();
  void onWoken();
  void beginDrain();
  [[nodiscard]] ServerStatus status() const;

  TransportOptions options_;
  SessionShared& shared_;
  TransportHandlers handlers_;
  struct ev_loop* loop_ = ev_loop_new(EVFLAG_AUTO);
  ev_timer tick_{};
  std::array<ev_signal, 2> signals_{};
  lws_context* context_ = nullptr;
  lws_vhost* metricsVhost_ = nullptr;
  int port_ = 0;
  int metricsPort_ = 0;
  std::unordered_set<Connection*> connections_;
  ConnectionCounter counter_;
  std::vector<std::uint8_t> scratch_;
  std::int64_t startedMs_ = nowMs();
  std::int64_t drainUntilMs_ = 0;  // 0: not draining
  std::uint64_t accepted_ = 0;
  std::uint64_t refused_ = 0;
  std::uint64_t sentBytes_ = 0;
  std::uint64_t sentMessages_ = 0;
  std::uint64_t receivedMessages_ = 0;
};

Transport* transportOf(lws* wsi) {
  return static_cast<Transport*>(lws_context_user(lws_get_context(wsi)));
}

int webSocketCallback(
    lws* wsi,
    lws_callback_reasons reason,
    void* user,
    void* in,
    std::size_t size) {
  return transportOf(wsi)->onWebSocket(wsi, reason, static_cast<PerSocket*>(user), in, size);
}

int httpCallback(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size) {
  Transport* transport = transportOf(wsi);
  // The library also calls while it makes its context, before there is anything to ask.
  if (transport == nullptr) return 0;
  return transport->onHttp(wsi, reason, static_cast<PerSocket*>(user), in, size);
}

const std::array<lws_protocols, 3> kProtocols = {{
    {"http", httpCallback, sizeof(PerSocket), kRxBufferBytes, 0, nullptr, kTxPacketBytes},
    {limits::kSubprotocol,
     webSocketCallback,
     sizeof(PerSocket),
     kRxBufferBytes,
     0,
     nullptr,
     kTxPacketBytes},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
}};

// Silent connections are pinged and hung up on.
const lws_retry_bo_t kLiveness = {nullptr, 0, 0, 20, 30, 0};

Result<void> Transport::start() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < files.rlim_max) {
    files.rlim_cur = files.rlim_max;
    static_cast<void>(setrlimit(RLIMIT_NOFILE, &files));
  }
  lws_set_log_level(LLL_ERR | LLL_WARN, logLine);
  ev_timer_init(
      &tick_,
      [](struct ev_loop*, ev_timer* watcher, int) {
        static_cast<Transport*>(watcher->data)->onTick();
      },
      kTickSeconds,
      kTickSeconds);
  tick_.data = this;
  ev_timer_start(loop_, &tick_);
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    ev_signal_init(
        &signals_[i],
        [](struct ev_loop*, ev_signal* watcher, int) {
          static_cast<Transport*>(watcher->data)->beginDrain();
        },
        i == 0 ? SIGTERM : SIGINT);
    signals_[i].data = this;
    ev_signal_start(loop_, &signals_[i]);
  }

  lws_context_creation_info info{};
  void* loops[] = {loop_};
  info.foreign_loops = loops;
  info.user = this;
  info.options = LWS_SERVER_OPTION_LIBEV | LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
                 LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
  info.fd_limit_per_thread =
      static_cast<unsigned>(std::min<rlim_t>(files.rlim_cur > 0 ? files.rlim_cur : 1024, 1U << 20));
  info.pt_serv_buf_size = static_cast<unsigned>(kTxPacketBytes);
  info.retry_and_idle_policy = &kLiveness;
  context_ = lws_create_context(&info);
  if (context_ == nullptr) {
    return fail(
        ErrorCode::kIo,
        "cannot start libwebsockets with libev; is libwebsockets-evlib-ev installed?");
  }
  const auto main = openVhost(options_.listen, "main");
  if (!main) return tl::unexpected(main.error());
  port_ = lws_get_vhost_listen_port(*main);
  if (options_.metricsListen) {
    const auto metrics = openVhost(*options_.metricsListen, "metrics");
    if (!metrics) return tl::unexpected(metrics.error());
    metricsVhost_ = *metrics;
    metricsPort_ = lws_get_vhost_listen_port(*metrics);
  }
  return {};
}

Result<lws_vhost*> Transport::openVhost(const ListenAddress& address, const char* name) {
  const bool isMain = std::string_view(name) == "main";
  lws_context_creation_info info{};
  info.port = address.port;
  info.iface = address.host.empty() || address.host == "0.0.0.0" ? nullptr : address.host.c_str();
  if (address.ipv6 && address.host == "::") info.iface = nullptr;
  info.vhost_name = name;
  info.protocols = kProtocols.data();
  info.timeout_secs = 10;
  info.keepalive_timeout = 15;
  info.retry_and_idle_policy = &kLiveness;
  if (!address.ipv6) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  info.alpn = "http/1.1";
  if (isMain && !options_.tlsCertificate.empty()) {
    info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    info.ssl_cert_filepath = options_.tlsCertificate.c_str();
    info.ssl_private_key_filepath = options_.tlsKey.c_str();
  }
  lws_vhost* vhost = lws_create_vhost(context_, &info);
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

int Transport::admit(lws* wsi) {
  const bool fine =
      drainUntilMs_ == 0 && lws_get_vhost(wsi) != metricsVhost_ &&
      options_.access.hasToken(header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION)) &&
      options_.access.allowsOrigin(header(wsi, WSI_TOKEN_ORIGIN), header(wsi, WSI_TOKEN_HOST));
  if (!fine) ++refused_;
  return fine ? 0 : 1;
}

int Transport::onWebSocket(
    lws* wsi,
    lws_callback_reasons reason,
    PerSocket* socket,
    void* in,
    std::size_t size) {
  switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return admit(wsi);
    case LWS_CALLBACK_ESTABLISHED: {
      const std::string address = addressOf(wsi);
      if (!counter_.enter(address, options_.access)) {
        ++refused_;
        socket->connection = nullptr;
        constexpr char kWhy[] = "too many clients; try again later";
        std::array<unsigned char, sizeof(kWhy)> why{};
        std::memcpy(why.data(), kWhy, sizeof(kWhy));
        lws_close_reason(wsi, static_cast<lws_close_status>(1013), why.data(), sizeof(kWhy) - 1);
        return -1;
      }
      ++accepted_;
      socket->connection = new Connection(wsi, address, shared_, nowMs());
      connections_.insert(socket->connection);
      return 0;
    }
    case LWS_CALLBACK_RECEIVE:
      return socket->connection != nullptr ? receive(*socket->connection, in, size) : -1;
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return socket->connection != nullptr ? write(*socket->connection) : -1;
    case LWS_CALLBACK_CLOSED:
      if (socket->connection != nullptr) {
        counter_.leave(socket->connection->address);
        connections_.erase(socket->connection);
        delete socket->connection;
        socket->connection = nullptr;
      }
      return 0;
    default:
      return 0;
  }
}

int Transport::receive(Connection& connection, const void* in, std::size_t size) {
  lws* wsi = connection.wsi;
  const auto* bytes = static_cast<const std::uint8_t*>(in);
  if (lws_frame_is_binary(wsi) == 0) {
    lws_close_reason(wsi, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, nullptr, 0);
    return -1;
  }
  auto& partial = connection.partial;
  if (partial.size() + size + lws_remaining_packet_payload(wsi) > limits::kMaxClientMessageBytes) {
    lws_close_reason(wsi, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, nullptr, 0);
    return -1;
  }
  const bool last = lws_is_final_fragment(wsi) != 0 && lws_remaining_packet_payload(wsi) == 0;
  if (!last) {
    partial.insert(partial.end(), bytes, bytes + size);
    return 0;
  }
  ++receivedMessages_;
  if (partial.empty()) {
    connection.session.receive({bytes, size}, nowMs());
    return 0;
  }
  partial.insert(partial.end(), bytes, bytes + size);
  connection.session.receive(partial, nowMs());
  partial = {};
  return 0;
}

int Transport::write(Connection& connection) {
  lws* wsi = connection.wsi;
  const auto message = connection.session.nextMessage(nowMs());
  if (!message) {
    const auto close = connection.session.close();
    if (!close) return 0;
    lws_close_reason(
        wsi,
        *close == Session::Close::kGoingAway ? LWS_CLOSE_STATUS_GOINGAWAY
                                             : LWS_CLOSE_STATUS_POLICY_VIOLATION,
        nullptr,
        0);
    return -1;
  }
  const protocol::Bytes bytes = message->bytes();
  // The library writes its frame header in front of what it is given.
  scratch_.resize(LWS_PRE + bytes.size());
  std::memcpy(scratch_.data() + LWS_PRE, bytes.data(), bytes.size());
  const int written = lws_write(wsi, scratch_.data() + LWS_PRE, bytes.size(), LWS_WRITE_BINARY);
  if (written < 0 || static_cast<std::size_t>(written) < bytes.size()) return -1;
  sentBytes_ += bytes.size();
  ++sentMessages_;
  lws_callback_on_writable(wsi);
  return 0;
}

int Transport::onHttp(
    lws* wsi,
    lws_callback_reasons reason,
    PerSocket* socket,
    void* in,
    std::size_t size) {
  switch (reason) {
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      onWoken();
      return 0;
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      return std::strcmp(static_cast<const char*>(in), "websocket") == 0 ? 0 : -1;
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return 1;  // a WebSocket without our subprotocol
    case LWS_CALLBACK_HTTP:
      return answer(wsi, *socket, {static_cast<const char*>(in), size});
    case LWS_CALLBACK_HTTP_WRITEABLE: {
      if (socket->body == nullptr) return 0;
      const std::string body = std::move(*socket->body);
      delete std::exchange(socket->body, nullptr);
      scratch_.resize(LWS_PRE + body.size());
      std::memcpy(scratch_.data() + LWS_PRE, body.data(), body.size());
      const int written =
          lws_write(wsi, scratch_.data() + LWS_PRE, body.size(), LWS_WRITE_HTTP_FINAL);
      if (written < 0) return -1;
      return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
    }
    case LWS_CALLBACK_CLOSED_HTTP:
      if (socket != nullptr) delete std::exchange(socket->body, nullptr);
      return 0;
    default:
      return lws_callback_http_dummy(wsi, reason, socket, in, size);
  }
}

int Transport::answer(lws* wsi, PerSocket& socket, std::string_view path) {
  HttpReply reply;
  const bool metrics = lws_get_vhost(wsi) == metricsVhost_ && metricsVhost_ != nullptr;
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0) {
    reply = {405, "text/plain; charset=utf-8", "only GET\n"};
  } else if (
      path == "/models" && !options_.access.hasToken(header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION))) {
    reply = {401, "text/plain; charset=utf-8", "send Authorization: Bearer TOKEN\n"};
  } else {
    reply = metrics ? routeMetrics(path, status(), handlers_.catalogue())
                    : routeMain(path, status(), handlers_.catalogue());
  }
  std::array<unsigned char, LWS_PRE + 1024> buffer{};
  unsigned char* at = buffer.data() + LWS_PRE;
  unsigned char* const begin = at;
  unsigned char* const end = buffer.data() + buffer.size() - 1;
  if (lws_add_http_common_headers(
          wsi,
          static_cast<unsigned>(reply.status),
          reply.contentType.c_str(),
          reply.body.size(),
          &at,
          end) != 0 ||
      lws_finalize_write_http_header(wsi, begin, &at, end) != 0) {
    return -1;
  }
  delete std::exchange(socket.body, new std::string(std::move(reply.body)));
  lws_callback_on_writable(wsi);
  return 0;
}

ServerStatus Transport::status() const {
  ServerStatus status = handlers_.status();
  if (drainUntilMs_ != 0) {
    status.ready = false;
    status.notReadyBecause = "draining";
  }
  status.connections = connections_.size();
  status.connectionsTotal = accepted_;
  status.connectionsRefusedTotal = refused_;
  status.sentBytesTotal = sentBytes_;
  status.sentMessagesTotal = sentMessages_;
  status.receivedMessagesTotal = receivedMessages_;
  status.uptimeSeconds = static_cast<double>(nowMs() - startedMs_) / 1000.0;
  for (const Connection* connection : connections_) {
    status.sessionBytes += sizeof(Connection) + connection->session.bytes();
  }
  return status;
}

void Transport::onTick() {
  const std::int64_t now = nowMs();
  if (handlers_.tick) handlers_.tick(now);
  for (Connection* connection : connections_) {
    connection->session.update(now);
    const bool late = !connection->session.greeted() &&
                      now - connection->session.bornMs() > options_.helloDeadlineMs;
    if (late) lws_set_timeout(connection->wsi, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
  }
  if (drainUntilMs_ != 0 && (connections_.empty() || now >= drainUntilMs_)) {
    ev_break(loop_, EVBREAK_ALL);
  }
}

void Transport::onWoken() {
  if (handlers_.woken) handlers_.woken();
  const std::int64_t now = nowMs();
  for (Connection* connection : connections_)
    connection->session.update(now);
}

void Transport::beginDrain() {
  if (drainUntilMs_ != 0) {
    // Asked twice: at once.
    drainUntilMs_ = nowMs();
    return;
  }
  drainUntilMs_ = nowMs() + options_.drainMs;
  // Spread over a while, so that clients do not all come back at the same moment.
  std::uint32_t spread = 0;
  for (Connection* connection : connections_) {
    connection->session.drain(kDrainRetryMs + spread);
    spread = (spread + 97) % kDrainSpreadMs;
  }
}

}  // namespace

std::int64_t LwsTransport::nowMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Result<std::unique_ptr<LwsTransport>> LwsTransport::open(
    const TransportOptions& options,
    SessionShared& shared,
    const TransportHandlers& handlers) {
  auto transport = std::make_unique<Transport>(options, shared, handlers);
  if (auto started = transport->start(); !started) return tl::unexpected(started.error());
  return transport;
}

void setTransportLog(std::function<void(const std::string&)> sink) {
  logSink() = std::move(sink);
}

}  // namespace limn
