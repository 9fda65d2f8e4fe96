// SPDX-License-Identifier: Apache-2.0
//
// The traps of libwebsockets 4.1 that shape this folder: without tx_packet_size a send is cut to
// the receive buffer; an IPv4 address binds every interface while IPv6 is on; lws_write() is for
// the writeable callback, once each; partial writes are the library's to finish;
// lws_cancel_service() is the one call for other threads; the descriptor table follows `ulimit -n`
// unless told; an Upgrade to anything but "websocket" is refused (use after free, NN-2025-0102); a
// timer costs time in proportion to those that are set. permessage-deflate stays off: packets do
// not deflate, and it costs 265 KiB a client.
#include "server/transport/lws_transport.h"

#include "server/transport/crowd.h"
#include "server/transport/door.h"
#include "server/transport/ledger.h"
#include "server/transport/lws_setup.h"

#include "protocol/limits.h"

#include <ev.h>
#include <libwebsockets.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr double kTickSeconds = 0.05;
constexpr std::size_t kSpareFiles = 128;  // besides clients: store, models, workers, HTTP

Socket* socketOf(lws* wsi) {
  return static_cast<Socket*>(lws_get_opaque_user_data(wsi));
}

class Transport final : public LwsTransport {
 public:
  Transport(const TransportOptions& options, SessionShared& shared, TransportHandlers handlers)
      : options_(options),
        shared_(shared),
        handlers_(std::move(handlers)),
        ledger_(handlers_.happened, nowMs()),
        door_(options_, handlers_.happened) {}

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

  int onWebSocket(lws* wsi, lws_callback_reasons reason, void* in, std::size_t size);
  int onHttp(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size);

 private:
  [[nodiscard]] bool isMetrics(lws* wsi) const {
    return metricsVhost_ != nullptr && lws_get_vhost(wsi) == metricsVhost_;
  }

  void accept(lws* wsi);
  void forget(lws* wsi);
  int admit(lws* wsi);
  int establish(lws* wsi);
  void ended(Socket& socket);
  int answer(lws* wsi, std::string_view path);
  int reply(lws* wsi, const HttpReply& reply);
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
  Ledger ledger_;
  Crowd crowd_;
  Door door_;
  std::vector<std::uint8_t> scratch_;
  std::int64_t drainUntilMs_ = 0;  // 0: not draining
  std::int64_t tickedMs_ = 0;
};

Transport* transportOf(lws* wsi) {
  return static_cast<Transport*>(lws_context_user(lws_get_context(wsi)));
}

int webSocketCallback(lws* wsi, lws_callback_reasons reason, void*, void* in, std::size_t size) {
  return transportOf(wsi)->onWebSocket(wsi, reason, in, size);
}

int httpCallback(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size) {
  Transport* transport = transportOf(wsi);
  // The library also calls while it makes its context, before there is anything to ask.
  if (transport == nullptr) return 0;
  return transport->onHttp(wsi, reason, user, in, size);
}

const std::array<lws_protocols, 3> kProtocols = {{
    {"http", httpCallback, 0, kRxBufferBytes, 0, nullptr, kTxPacketBytes},
    {limits::kSubprotocol, webSocketCallback, 0, kRxBufferBytes, 0, nullptr, kTxPacketBytes},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
}};

Result<void> Transport::start() {
  const std::size_t mostFiles = raiseFileLimit();
  const std::size_t mostClients = mostFiles - std::min(mostFiles / 2, kSpareFiles);
  if (options_.limits.maxClients > mostClients) {
    logTransport(
        "at most " + std::to_string(mostClients) + " clients: the limit of open files is " +
        std::to_string(mostFiles));
    options_.limits.maxClients = mostClients;
  }
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

  context_ = makeContext(loop_, this, mostFiles);
  if (context_ == nullptr) {
    return fail(
        ErrorCode::kIo,
        "cannot start libwebsockets with libev; is libwebsockets-evlib-ev installed?");
  }
  const bool hasTls = !options_.tlsCertificate.empty();
  const auto main = openPort(
      context_,
      {options_.listen,
       "main",
       kProtocols.data(),
       options_.limits.handshakeMs,
       hasTls ? options_.tlsCertificate.c_str() : nullptr,
       hasTls ? options_.tlsKey.c_str() : nullptr});
  if (!main) return tl::unexpected(main.error());
  port_ = lws_get_vhost_listen_port(*main);
  if (options_.metricsListen) {
    const auto metrics = openPort(
        context_,
        {*options_.metricsListen, "metrics", kProtocols.data(), options_.limits.handshakeMs});
    if (!metrics) return tl::unexpected(metrics.error());
    metricsVhost_ = *metrics;
    metricsPort_ = lws_get_vhost_listen_port(*metrics);
  }
  return {};
}

void Transport::accept(lws* wsi) {
  auto* socket = new Socket;
  socket->wsi = wsi;
  socket->address = addressOf(lws_get_socket_fd(wsi));
  socket->deadlineMs = nowMs() + options_.limits.handshakeMs;
  door_.enter(socket->address);
  crowd_.add(*socket);
  lws_set_opaque_user_data(wsi, socket);
}

void Transport::forget(lws* wsi) {
  Socket* socket = socketOf(wsi);
  if (socket == nullptr) return;
  lws_set_opaque_user_data(wsi, nullptr);
  ended(*socket);
  door_.leave(socket->address);
  crowd_.remove(*socket);
  delete socket;
}

int Transport::admit(lws* wsi) {
  Socket* socket = socketOf(wsi);
  if (socket == nullptr || !Door::asksForWebSocket(wsi)) return -1;
  const auto port = isMetrics(wsi)       ? Door::Port::kMetrics
                    : drainUntilMs_ != 0 ? Door::Port::kDraining
                                         : Door::Port::kMain;
  const auto refusal = door_.refuse(wsi, *socket, port);
  return refusal ? reply(wsi, *refusal) : 0;
}

int Transport::establish(lws* wsi) {
  Socket* socket = socketOf(wsi);
  if (socket == nullptr) return -1;
  door_.enterClient(socket->address);
  socket->connection = std::make_unique<Connection>(
      Connection::Client{wsi, ledger_.nextNumber(), socket->grant},
      Connection::Shared{options_.limits, shared_, ledger_.traffic(), scratch_},
      nowMs());
  crowd_.connect(*socket);
  ledger_.noteOpened(*socket);
  return 0;
}

void Transport::ended(Socket& socket) {
  if (!socket.connection) return;
  const std::unique_ptr<Connection> connection = std::move(socket.connection);
  door_.leaveClient(socket.address);
  crowd_.remove(socket);
  ledger_.noteClosed(socket, *connection, nowMs());
}

int Transport::onWebSocket(lws* wsi, lws_callback_reasons reason, void* in, std::size_t size) {
  Socket* socket = socketOf(wsi);
  switch (reason) {
    case LWS_CALLBACK_ESTABLISHED:
      return establish(wsi);
    case LWS_CALLBACK_RECEIVE: {
      if (socket == nullptr || !socket->connection) return -1;
      const int result = socket->connection->receive(in, size, nowMs());
      crowd_.noteDue(*socket);
      return result;
    }
    case LWS_CALLBACK_SERVER_WRITEABLE: {
      if (socket == nullptr || !socket->connection) return -1;
      const int result = socket->connection->write(nowMs());
      crowd_.noteDue(*socket);
      return result;
    }
    case LWS_CALLBACK_RECEIVE_PONG:
      if (socket != nullptr && socket->connection) socket->connection->answered(nowMs());
      return 0;
    case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
      return socket != nullptr && socket->connection
                 ? socket->connection->closedByPeer({static_cast<const char*>(in), size})
                 : -1;
    case LWS_CALLBACK_CLOSED:
      if (socket != nullptr) ended(*socket);
      return 0;
    default:
      return 0;
  }
}

int Transport::onHttp(
    lws* wsi,
    lws_callback_reasons reason,
    void* user,
    void* in,
    std::size_t size) {
  switch (reason) {
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
      onWoken();
      return 0;
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
      return isMetrics(wsi) ? 0
                            : door_.filter(static_cast<int>(reinterpret_cast<std::intptr_t>(in)));
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
      accept(wsi);
      return 0;
    case LWS_CALLBACK_WSI_DESTROY:
      forget(wsi);
      return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
      return admit(wsi);
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return 1;  // a WebSocket without our subprotocol
    case LWS_CALLBACK_HTTP:
      return answer(wsi, {static_cast<const char*>(in), size});
    default:
      return lws_callback_http_dummy(wsi, reason, user, in, size);
  }
}

int Transport::answer(lws* wsi, std::string_view path) {
  Socket* socket = socketOf(wsi);
  if (socket == nullptr) return -1;
  HttpReply made;
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0) {
    // Whatever body it has is not read.
    made = {405, "text/plain; charset=utf-8", "only GET\n", {{"allow", "GET"}}, true};
  } else if (isMetrics(wsi)) {
    made = routeMetrics(path, status(), handlers_.catalogue());
  } else if (const auto grant = door_.grantOf(wsi)) {
    made = routeMain(path, status(), handlers_.catalogue(), grant->get());
  } else if (path == "/livez" || path == "/readyz") {
    // For those who only watch over it; why it is not ready is nobody else's business.
    ServerStatus known = status();
    known.notReadyBecause = "not ready";
    made = routeMain(path, known, {});
  } else {
    made = door_.turnAway(Refusal::kToken, socket->address, grant.error().message);
  }
  return reply(wsi, made);
}

/// The answer, headers and body in one piece, which the library sends as the client takes it.
int Transport::reply(lws* wsi, const HttpReply& reply) {
  const std::string text = httpText(reply);
  scratch_.resize(LWS_PRE + text.size());
  std::memcpy(scratch_.data() + LWS_PRE, text.data(), text.size());
  if (lws_write(wsi, scratch_.data() + LWS_PRE, text.size(), LWS_WRITE_HTTP) < 0) return -1;
  if (Socket* socket = socketOf(wsi)) {
    socket->answered = true;
    socket->deadlineMs = nowMs() + options_.limits.progressMs;
  }
  if (reply.close) return -1;
  return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
}

ServerStatus Transport::status() const {
  ServerStatus status = handlers_.status();
  if (drainUntilMs_ != 0) {
    status.ready = false;
    status.notReadyBecause = "draining";
  }
  ledger_.tell(status, nowMs());
  for (std::size_t i = 0; i < door_.refused().size(); ++i)
    status.connectionsRefusedTotal[nameOf(static_cast<Refusal>(i))] = door_.refused()[i];
  status.connections = crowd_.size();
  status.sessionBytes = crowd_.bytes();
  status.posesTotal = shared_.poses;
  status.posesReplacedTotal = shared_.posesReplaced;
  return status;
}

void Transport::onTick() {
  const std::int64_t now = nowMs();
  if (tickedMs_ != 0) {
    const double since = static_cast<double>(now - tickedMs_) / 1000.0;
    ledger_.noteLag(std::max(0.0, since - kTickSeconds));
  }
  const std::int64_t sinceMs = tickedMs_ == 0 ? 0 : now - tickedMs_;
  tickedMs_ = now;
  if (handlers_.tick) handlers_.tick(now);
  crowd_.update(now);
  const bool cuts = crowd_.cutLate(now, sinceMs, [this](const Socket& late) {
    if (late.answered || !options_.tlsCertificate.empty()) return;
    sayAtTheDoor(
        lws_get_socket_fd(late.wsi),
        408,
        "no request within " + std::to_string(options_.limits.handshakeMs) + " ms");
  });
  // The library looks at its timers only after events of its own.
  if (cuts) lws_cancel_service(context_);
  if (drainUntilMs_ != 0 && (crowd_.isEmpty() || now >= drainUntilMs_)) {
    ev_break(loop_, EVBREAK_ALL);
  }
}

void Transport::onWoken() {
  if (handlers_.woken) handlers_.woken();
  crowd_.update(nowMs());
}

void Transport::beginDrain() {
  if (drainUntilMs_ != 0) {
    // Asked twice: at once.
    drainUntilMs_ = nowMs();
    return;
  }
  drainUntilMs_ = nowMs() + options_.drainMs;
  crowd_.drain();
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

}  // namespace limn
