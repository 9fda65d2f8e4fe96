// SPDX-License-Identifier: Apache-2.0
//
// The traps of libwebsockets 4.1 that shape this file: without tx_packet_size a send is cut to the
// receive buffer; an IPv4 address binds every interface while IPv6 is on; lws_write() is for the
// writeable callback, once each; partial writes are the library's to finish; lws_cancel_service()
// is the one call for other threads; the descriptor table follows `ulimit -n` unless told; an
// Upgrade to anything but "websocket" is refused (use after free, NN-2025-0102); a timer costs time
// in proportion to those that are set. permessage-deflate stays off: packets do not deflate, and it
// costs 265 KiB a client.
#include "server/transport/lws_transport.h"

#include "server/transport/connection.h"

#include "protocol/limits.h"

#include <ev.h>
#include <libwebsockets.h>
#include <netdb.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <unordered_set>
#include <utility>
#include <vector>

namespace limn {
namespace {

constexpr double kTickSeconds = 0.05;
constexpr std::int64_t kLookMs = 1000;     // deadlines are looked at so often
constexpr std::size_t kLookedAtOnce = 64;  // by a tick, at least
constexpr std::size_t kTxPacketBytes = 64 * 1024;
constexpr std::size_t kRxBufferBytes = 4 * 1024;
constexpr std::size_t kMaxHeaderBytes = 4 * 1024;  // of a request
constexpr std::size_t kSpareFiles = 128;           // besides clients: store, models, workers, HTTP
constexpr std::size_t kSpareSockets = 16;          // besides clients, and as many from one address
constexpr double kLoggedRefusals = 10.0;           // a second: a flood must not fill the disk
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
  const int length = lws_hdr_total_length(wsi, token);
  if (length <= 0) return {};
  std::string value(static_cast<std::size_t>(length) + 1, '\0');
  const int copied = lws_hdr_copy(wsi, value.data(), length + 1, token);
  value.resize(copied > 0 ? static_cast<std::size_t>(copied) : 0);
  return value;
}

/// Who is at the other end, as limits count it.
std::string addressOf(int file) {
  sockaddr_storage peer{};
  socklen_t size = sizeof(peer);
  std::array<char, 64> text{};
  if (getpeername(file, reinterpret_cast<sockaddr*>(&peer), &size) != 0 ||
      getnameinfo(
          reinterpret_cast<sockaddr*>(&peer),
          size,
          text.data(),
          text.size(),
          nullptr,
          0,
          NI_NUMERICHOST) != 0) {
    return "unknown";
  }
  return addressKey(text.data());
}

/// A word to somebody whose request will not be read. Best effort: it may be lost.
void sayAtTheDoor(int file, int status, const std::string& why) {
  HttpReply reply{status, "text/plain; charset=utf-8", why + "\n", {}, true};
  const std::string text = httpText(reply);
  static_cast<void>(::send(file, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
}

/// Closes a socket soon, from outside its callbacks.
void cut(lws* wsi) {
  lws_set_timeout(wsi, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
}

/// What stays with a socket from being accepted to being closed.
struct Socket {
  lws* wsi = nullptr;
  std::string address;
  std::int64_t deadlineMs = 0;  // for its request, or its answer; 0: none, it is a WebSocket
  bool answered = false;
  std::shared_ptr<const Grant> grant;  // of an upgrade that is let in
  std::unique_ptr<Connection> connection;
  std::size_t place = kNowhere;        // among those with a connection
  std::size_t livelyPlace = kNowhere;  // among the lively ones
  std::int64_t dueMs = 0;              // of those: when to update it

  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
};

/// Some sockets; each knows its place, so that coming and going cost the same for any number.
template <std::size_t Socket::*Place>
class SocketList {
 public:
  [[nodiscard]] std::size_t size() const { return sockets_.size(); }

  [[nodiscard]] bool empty() const { return sockets_.empty(); }

  [[nodiscard]] Socket& operator[](std::size_t i) const { return *sockets_[i]; }

  [[nodiscard]] auto begin() const { return sockets_.begin(); }

  [[nodiscard]] auto end() const { return sockets_.end(); }

  void add(Socket& socket) {
    if (socket.*Place != Socket::kNowhere) return;
    socket.*Place = sockets_.size();
    sockets_.push_back(&socket);
  }

  /// The last one takes its place.
  void remove(Socket& socket) {
    const std::size_t place = std::exchange(socket.*Place, Socket::kNowhere);
    if (place == Socket::kNowhere) return;
    sockets_[place] = sockets_.back();
    if (sockets_[place] != &socket) sockets_[place]->*Place = place;
    sockets_.pop_back();
  }

 private:
  std::vector<Socket*> sockets_;
};

std::string subjectOf(const Socket& socket) {
  return socket.grant ? socket.grant->subject : std::string();
}

Socket* socketOf(lws* wsi) {
  return static_cast<Socket*>(lws_get_opaque_user_data(wsi));
}

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

  int onWebSocket(lws* wsi, lws_callback_reasons reason, void* in, std::size_t size);
  int onHttp(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size);

 private:
  Result<lws_vhost*> openVhost(const ListenAddress& address, const char* name);

  [[nodiscard]] bool isMetrics(lws* wsi) const {
    return metricsVhost_ != nullptr && lws_get_vhost(wsi) == metricsVhost_;
  }

  int filter(int file);
  void accept(lws* wsi);
  void forget(lws* wsi);
  int admit(lws* wsi);
  [[nodiscard]] std::optional<HttpReply> refuse(lws* wsi, Socket& socket);
  [[nodiscard]] Result<std::shared_ptr<const Grant>> grantOf(lws* wsi) const;
  int establish(lws* wsi);
  void ended(Socket& socket);
  int answer(lws* wsi, std::string_view path);
  int reply(lws* wsi, const HttpReply& reply);
  [[nodiscard]] HttpReply
  turnAway(Refusal why, const std::string& address, const std::string& text);
  void countRefusal(Refusal why, const std::string& address);
  void onTick();
  void onWoken();
  void noteDue(Socket& socket);
  void updateLively(std::int64_t now);
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
  std::unordered_set<Socket*> young_;  // with a deadline
  SocketList<&Socket::place> connected_;
  SocketList<&Socket::livelyPlace> lively_;  // to be updated
  std::size_t looked_ = 0;                   // whose deadlines come next, of connected_
  ConnectionCounter sockets_;
  ConnectionCounter clients_;
  std::vector<std::uint8_t> scratch_;
  std::int64_t startedMs_ = nowMs();
  std::int64_t drainUntilMs_ = 0;  // 0: not draining
  std::uint64_t accepted_ = 0;
  std::array<std::uint64_t, 6> refused_{};  // by Refusal
  std::array<std::uint64_t, 7> endings_{};  // by Ending
  TrafficCounters traffic_;
  TimeCounts loopLag_;
  std::int64_t tickedMs_ = 0;
  RateLimit refusalLog_{kLoggedRefusals, kLoggedRefusals};
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

// Connections ping by themselves: the library sorts its timers into a list from its front, so that
// each of 15,000 would be passed for every one that is set.
const lws_retry_bo_t kNoPings = {nullptr, 0, 0, 0, 0, 0};

Result<void> Transport::start() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < files.rlim_max) {
    files.rlim_cur = files.rlim_max;
    static_cast<void>(setrlimit(RLIMIT_NOFILE, &files));
  }
  const std::size_t mostFiles =
      files.rlim_cur > 0 ? static_cast<std::size_t>(files.rlim_cur) : 1024;
  const std::size_t mostClients = mostFiles - std::min(mostFiles / 2, kSpareFiles);
  if (options_.limits.maxClients > mostClients) {
    logLine(
        0,
        ("at most " + std::to_string(mostClients) + " clients: the limit of open files is " +
         std::to_string(mostFiles))
            .c_str());
    options_.limits.maxClients = mostClients;
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
  info.max_http_header_data = kMaxHeaderBytes;
  info.fd_limit_per_thread = static_cast<unsigned>(std::min<std::size_t>(mostFiles, 1U << 20));
  info.pt_serv_buf_size = static_cast<unsigned>(kTxPacketBytes);
  info.retry_and_idle_policy = &kNoPings;
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
  // Ours comes first; this one is for what never becomes a socket of ours (TLS handshakes).
  info.timeout_secs = static_cast<unsigned>(options_.limits.handshakeMs / 1000 + 1);
  info.keepalive_timeout = 15;
  info.retry_and_idle_policy = &kNoPings;
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

int Transport::filter(int file) {
  const TransportLimits& limits = options_.limits;
  const std::string address = addressOf(file);
  const std::size_t perAddress =
      limits.maxClientsPerAddress == 0 ? 0 : limits.maxClientsPerAddress + kSpareSockets;
  const auto full = sockets_.full(address, limits.maxClients + kSpareSockets, perAddress);
  if (!full) return 0;
  countRefusal(*full, address);
  if (options_.tlsCertificate.empty()) {
    sayAtTheDoor(file, 503, "too many connections");
  }
  return 1;
}

void Transport::accept(lws* wsi) {
  auto* socket = new Socket;
  socket->wsi = wsi;
  socket->address = addressOf(lws_get_socket_fd(wsi));
  socket->deadlineMs = nowMs() + options_.limits.handshakeMs;
  sockets_.enter(socket->address);
  young_.insert(socket);
  lws_set_opaque_user_data(wsi, socket);
}

void Transport::forget(lws* wsi) {
  Socket* socket = socketOf(wsi);
  if (socket == nullptr) return;
  lws_set_opaque_user_data(wsi, nullptr);
  ended(*socket);
  sockets_.leave(socket->address);
  young_.erase(socket);
  delete socket;
}

void Transport::countRefusal(Refusal why, const std::string& address) {
  ++refused_[static_cast<std::size_t>(why)];
  if (!handlers_.happened || !refusalLog_.take(nowMs())) return;
  handlers_.happened({TransportEvent::Kind::kRefused, 0, address, nameOf(why)});
}

HttpReply Transport::turnAway(Refusal why, const std::string& address, const std::string& text) {
  countRefusal(why, address);
  return refusalReply(why, text);
}

Result<std::shared_ptr<const Grant>> Transport::grantOf(lws* wsi) const {
  return options_.access.admit(header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION), std::time(nullptr));
}

std::optional<HttpReply> Transport::refuse(lws* wsi, Socket& socket) {
  const auto away = [&](Refusal why, const std::string& text) {
    return turnAway(why, socket.address, text);
  };
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0 ||
      header(wsi, WSI_TOKEN_HTTP) != "HTTP/1.1") {
    return away(Refusal::kRequest, "an upgrade is a GET of HTTP/1.1");
  }
  if (isMetrics(wsi)) return away(Refusal::kRequest, "there are no WebSockets on this port");
  if (drainUntilMs_ != 0) return away(Refusal::kDraining, "the server is going down");
  auto grant = grantOf(wsi);
  if (!grant) return away(Refusal::kToken, grant.error().message);
  if (!options_.access.allowsOrigin(header(wsi, WSI_TOKEN_ORIGIN), header(wsi, WSI_TOKEN_HOST))) {
    return away(Refusal::kOrigin, "pages of that origin may not connect");
  }
  const std::string version = header(wsi, WSI_TOKEN_VERSION);
  const std::string key = header(wsi, WSI_TOKEN_KEY);
  const std::string protocols = header(wsi, WSI_TOKEN_PROTOCOL);
  if (auto reply = refuseUpgrade({version, key, protocols})) {
    countRefusal(Refusal::kRequest, socket.address);
    return reply;
  }
  const TransportLimits& limits = options_.limits;
  const auto full = clients_.full(socket.address, limits.maxClients, limits.maxClientsPerAddress);
  if (full == Refusal::kTotal) return away(*full, "too many clients; try again later");
  if (full == Refusal::kAddress) {
    return away(
        *full,
        "too many connections from your address; at most " +
            std::to_string(limits.maxClientsPerAddress));
  }
  socket.grant = std::move(*grant);
  return std::nullopt;
}

int Transport::admit(lws* wsi) {
  Socket* socket = socketOf(wsi);
  // The library answers an unknown upgrade and frees its headers, then asks all the same: what it
  // passes as the upgrade's name may be gone (NN-2025-0102).
  if (socket == nullptr || lws_hdr_total_length(wsi, WSI_TOKEN_UPGRADE) <= 0) return -1;
  const std::string upgrade = header(wsi, WSI_TOKEN_UPGRADE);
  if (strcasecmp(upgrade.c_str(), "websocket") != 0) return -1;
  const auto refusal = refuse(wsi, *socket);
  return refusal ? reply(wsi, *refusal) : 0;
}

int Transport::establish(lws* wsi) {
  Socket* socket = socketOf(wsi);
  if (socket == nullptr) return -1;
  clients_.enter(socket->address);
  young_.erase(socket);
  socket->deadlineMs = 0;
  socket->connection = std::make_unique<Connection>(
      Connection::Client{wsi, ++accepted_, socket->grant},
      Connection::Shared{options_.limits, shared_, traffic_, scratch_},
      nowMs());
  connected_.add(*socket);
  if (handlers_.happened) {
    handlers_.happened(
        {TransportEvent::Kind::kOpened,
         accepted_,
         socket->address,
         {},
         0.0,
         0,
         subjectOf(*socket)});
  }
  return 0;
}

void Transport::ended(Socket& socket) {
  if (!socket.connection) return;
  const std::unique_ptr<Connection> connection = std::move(socket.connection);
  clients_.leave(socket.address);
  connected_.remove(socket);
  lively_.remove(socket);
  ++endings_[static_cast<std::size_t>(connection->ending())];
  if (!handlers_.happened) return;
  std::string why = nameOf(connection->ending());
  if (!connection->endingReason().empty()) why += ": " + connection->endingReason();
  handlers_.happened(
      {TransportEvent::Kind::kClosed,
       connection->number(),
       socket.address,
       why,
       static_cast<double>(nowMs() - connection->bornMs()) / 1000.0,
       connection->payloadBytes(),
       subjectOf(socket)});
}

int Transport::onWebSocket(lws* wsi, lws_callback_reasons reason, void* in, std::size_t size) {
  Socket* socket = socketOf(wsi);
  switch (reason) {
    case LWS_CALLBACK_ESTABLISHED:
      return establish(wsi);
    case LWS_CALLBACK_RECEIVE: {
      if (socket == nullptr || !socket->connection) return -1;
      const int result = socket->connection->receive(in, size, nowMs());
      noteDue(*socket);
      return result;
    }
    case LWS_CALLBACK_SERVER_WRITEABLE: {
      if (socket == nullptr || !socket->connection) return -1;
      const int result = socket->connection->write(nowMs());
      noteDue(*socket);
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
      return isMetrics(wsi) ? 0 : filter(static_cast<int>(reinterpret_cast<std::intptr_t>(in)));
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
  } else if (const auto grant = grantOf(wsi)) {
    made = routeMain(path, status(), handlers_.catalogue(), grant->get());
  } else if (path == "/livez" || path == "/readyz") {
    // For those who only watch over it; why it is not ready is nobody else's business.
    ServerStatus known = status();
    known.notReadyBecause = "not ready";
    made = routeMain(path, known, {});
  } else {
    made = turnAway(Refusal::kToken, socket->address, grant.error().message);
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
  status.connections = connected_.size();
  status.connectionsTotal = accepted_;
  for (std::size_t i = 0; i < refused_.size(); ++i)
    status.connectionsRefusedTotal[nameOf(static_cast<Refusal>(i))] = refused_[i];
  for (std::size_t i = 0; i < endings_.size(); ++i)
    status.connectionsClosedTotal[nameOf(static_cast<Ending>(i))] = endings_[i];
  status.sentBytesTotal = traffic_.sentBytes;
  status.sentMessagesTotal = traffic_.sentMessages;
  status.receivedMessagesTotal = traffic_.receivedMessages;
  status.loopLag = loopLag_;
  status.posesTotal = shared_.poses;
  status.posesReplacedTotal = shared_.posesReplaced;
  status.uptimeSeconds = static_cast<double>(nowMs() - startedMs_) / 1000.0;
  for (const Socket* socket : connected_)
    status.sessionBytes += socket->connection->bytes();
  return status;
}

void Transport::onTick() {
  const std::int64_t now = nowMs();
  if (tickedMs_ != 0) {
    const double since = static_cast<double>(now - tickedMs_) / 1000.0;
    loopLag_.add(std::max(0.0, since - kTickSeconds));
  }
  const std::int64_t sinceMs = tickedMs_ == 0 ? 0 : now - tickedMs_;
  tickedMs_ = now;
  if (handlers_.tick) handlers_.tick(now);
  updateLively(now);
  bool cuts = false;
  const std::size_t some = std::max<std::size_t>(
      kLookedAtOnce,
      connected_.size() * static_cast<std::size_t>(sinceMs) / kLookMs + 1);
  for (std::size_t i = std::min(some, connected_.size()); i > 0; --i) {
    looked_ = looked_ + 1 < connected_.size() ? looked_ + 1 : 0;
    Socket& socket = connected_[looked_];
    if (socket.connection->tick(now)) {
      noteDue(socket);
      continue;
    }
    cut(socket.wsi);
    cuts = true;
  }
  for (Socket* socket : young_) {
    if (socket->deadlineMs == 0 || now < socket->deadlineMs) continue;
    socket->deadlineMs = 0;
    if (!socket->answered && options_.tlsCertificate.empty()) {
      sayAtTheDoor(
          lws_get_socket_fd(socket->wsi),
          408,
          "no request within " + std::to_string(options_.limits.handshakeMs) + " ms");
    }
    cut(socket->wsi);
    cuts = true;
  }
  // The library looks at its timers only after events of its own.
  if (cuts) lws_cancel_service(context_);
  if (drainUntilMs_ != 0 && (connected_.empty() || now >= drainUntilMs_)) {
    ev_break(loop_, EVBREAK_ALL);
  }
}

void Transport::onWoken() {
  if (handlers_.woken) handlers_.woken();
  updateLively(nowMs());
}

void Transport::noteDue(Socket& socket) {
  const auto due = socket.connection->dueMs();
  socket.dueMs = due.value_or(0);
  if (due) {
    lively_.add(socket);
  } else {
    lively_.remove(socket);
  }
}

void Transport::updateLively(std::int64_t now) {
  for (std::size_t i = 0; i < lively_.size();) {
    Socket& socket = lively_[i];
    if (socket.dueMs <= now) {
      socket.connection->update(now);
      noteDue(socket);
    }
    // The last one may have taken its place.
    if (socket.livelyPlace == i) ++i;
  }
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
  for (const Socket* socket : connected_) {
    socket->connection->drain(kDrainRetryMs + spread);
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
