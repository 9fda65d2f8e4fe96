// SPDX-License-Identifier: Apache-2.0
#include "client/net/lws_connection.h"

#include "client/net/lws_client.h"

#include "protocol/framing.h"
#include "protocol/limits.h"

#include <libwebsockets.h>

#include <algorithm>
#include <deque>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

namespace limn {
namespace {

constexpr std::size_t kReceiveBufferBytes = 64 * 1024;

class LwsConnection final : public Connection {
 public:
  explicit LwsConnection(LwsConnectionOptions options) : options_(std::move(options)) {}

  ~LwsConnection() override { close(); }

  void start(ConnectionListener& listener) override {
    listener_ = &listener;
    thread_ = std::thread([this] { serve(); });
  }

  void send(std::vector<std::uint8_t> message) override {
    const std::lock_guard lock(mutex_);
    outgoing_.push_back(std::move(message));
    if (context_ != nullptr) lws_cancel_service(context_);
  }

  void close() override {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      if (context_ != nullptr) lws_cancel_service(context_);
    }
    if (thread_.joinable()) thread_.join();
  }

 private:
  static int
  callback(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t length) {
    lws_context* context = lws_get_context(wsi);
    auto* self =
        context == nullptr ? nullptr : static_cast<LwsConnection*>(lws_context_user(context));
    if (self == nullptr) return lws_callback_http_dummy(wsi, reason, user, in, length);
    return self->on(wsi, reason, in, length);
  }

  void serve() {
    static const lws_protocols kProtocols[] = {
        {limits::kSubprotocol, &LwsConnection::callback, 0, kReceiveBufferBytes, 0, nullptr, 0},
        {nullptr, nullptr, 0, 0, 0, nullptr, 0}};
    const lws_context_creation_info info = clientContextInfo(options_, kProtocols, this);
    lws_context* context = lws_create_context(&info);
    if (context == nullptr) return lost("cannot set up the network library");
    {
      const std::lock_guard lock(mutex_);
      context_ = context;
    }
    connect(context);
    while (!done_ && !isStopping()) {
      if (lws_service(context, 0) < 0) break;
    }
    {
      const std::lock_guard lock(mutex_);
      context_ = nullptr;
      // Closing the context calls back about the socket; that is no news for the listener.
      stopping_ = true;
    }
    lws_context_destroy(context);
  }

  void connect(lws_context* context) {
    const std::string host = options_.url.host + ":" + std::to_string(options_.url.port);
    lws_client_connect_info info{};
    info.context = context;
    info.address = options_.url.host.c_str();
    info.port = options_.url.port;
    info.path = options_.url.path.c_str();
    info.host = host.c_str();
    info.protocol = limits::kSubprotocol;
    info.local_protocol_name = limits::kSubprotocol;
    info.ietf_version_or_minus_one = -1;
    if (options_.url.tls) info.ssl_connection = LCCSCF_USE_SSL;
    info.pwsi = &wsi_;
    if (lws_client_connect_via_info(&info) == nullptr) lost(describeConnectError({}, 0));
  }

  int on(lws* wsi, lws_callback_reasons reason, void* in, std::size_t length) {
    switch (reason) {
      case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER:
        return addBearerToken(wsi, options_.token, in, length);
      case LWS_CALLBACK_CLIENT_ESTABLISHED:
        established_ = true;
        if (!isStopping()) listener_->onOpen();
        lws_callback_on_writable(wsi);
        return 0;
      case LWS_CALLBACK_CLIENT_RECEIVE:
        return receive(wsi, in, length);
      case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        if (established_ && wsi_ != nullptr) lws_callback_on_writable(wsi_);
        return 0;
      case LWS_CALLBACK_CLIENT_WRITEABLE:
        return write(wsi);
      case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
        if (length >= 2) {
          const auto* code = static_cast<const std::uint8_t*>(in);
          closeCode_ = static_cast<std::uint16_t>(code[0] << 8 | code[1]);
        }
        return 0;
      case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
        lost(describeConnectError(
            in == nullptr ? std::string_view{}
                          : std::string_view(static_cast<const char*>(in), length),
            static_cast<int>(lws_http_client_http_response(wsi))));
        return 0;
      case LWS_CALLBACK_CLIENT_CLOSED:
        lost(describeClose());
        return 0;
      default:
        return 0;
    }
  }

  int receive(lws* wsi, const void* in, std::size_t length) {
    const std::size_t remaining = lws_remaining_packet_payload(wsi);
    // A frame begins where the one before ended; its header is paid once.
    if (frameRemaining_ == 0) wireBytes_ += protocol::webSocketHeaderBytes(length + remaining);
    frameRemaining_ = remaining;
    wireBytes_ += length;
    if (incoming_.size() + length + remaining > limits::kMaxServerMessageBytes) {
      lost("the server sent a message longer than the protocol allows");
      return -1;
    }
    if (incoming_.empty()) incoming_.reserve(length + remaining);
    const auto* bytes = static_cast<const std::uint8_t*>(in);
    incoming_.insert(incoming_.end(), bytes, bytes + length);
    if (remaining != 0 || lws_is_final_fragment(wsi) == 0) return 0;
    if (lws_frame_is_binary(wsi) == 0) {
      lost("the server sent text where the protocol has binary messages");
      return -1;
    }
    if (!isStopping()) listener_->onMessage(std::move(incoming_), wireBytes_);
    incoming_ = {};
    wireBytes_ = 0;
    return 0;
  }

  int write(lws* wsi) {
    std::vector<std::uint8_t> message;
    bool more = false;
    {
      const std::lock_guard lock(mutex_);
      if (outgoing_.empty()) return 0;
      message = std::move(outgoing_.front());
      outgoing_.pop_front();
      more = !outgoing_.empty();
    }
    scratch_.resize(LWS_PRE + message.size());
    std::copy(message.begin(), message.end(), scratch_.begin() + LWS_PRE);
    if (lws_write(wsi, scratch_.data() + LWS_PRE, message.size(), LWS_WRITE_BINARY) < 0) return -1;
    if (more) lws_callback_on_writable(wsi);
    return 0;
  }

  /// status: of the server's answer to the upgrade; 0: there was none.
  [[nodiscard]] std::string describeConnectError(std::string_view detail, int status) const {
    std::string what = "cannot connect to " + options_.url.text();
    if (status == 401 || detail.find("unauthorized") != std::string_view::npos) {
      return what + (options_.token.empty()
                         ? ": the server asks for a token, give it with --token-file"
                         : ": the server does not take this token (another server's, or expired), "
                           "give a new one with --token-file");
    }
    if (status == 429) {
      return what + ": the server allows no more connections from this address; close others";
    }
    if (status == 503) {
      return what + ": the server is full or going down; try again later";
    }
    if (!detail.empty()) what += " (" + std::string(detail) + ")";
    return what + ": check the address and that limn-server runs there";
  }

  [[nodiscard]] std::string describeClose() const {
    std::string what = "the connection to " + options_.url.text() + " ended";
    if (closeCode_ == LWS_CLOSE_STATUS_GOINGAWAY) return what + ": the server is shutting down";
    if (closeCode_ != 0) what += " (close code " + std::to_string(closeCode_) + ")";
    return what;
  }

  void lost(const std::string& why) {
    const bool told = std::exchange(done_, true);
    wsi_ = nullptr;
    if (!told && !isStopping()) listener_->onClosed({ErrorCode::kNetwork, why});
  }

  [[nodiscard]] bool isStopping() {
    const std::lock_guard lock(mutex_);
    return stopping_;
  }

  // Constant after start().
  const LwsConnectionOptions options_;
  ConnectionListener* listener_ = nullptr;
  std::thread thread_;

  // Network thread only.
  lws* wsi_ = nullptr;
  bool established_ = false;
  bool done_ = false;
  std::vector<std::uint8_t> incoming_;
  std::size_t frameRemaining_ = 0;
  std::size_t wireBytes_ = 0;
  std::vector<std::uint8_t> scratch_;
  std::uint16_t closeCode_ = 0;

  // Guarded by mutex_.
  std::mutex mutex_;
  lws_context* context_ = nullptr;
  std::deque<std::vector<std::uint8_t>> outgoing_;
  bool stopping_ = false;
};

}  // namespace

std::unique_ptr<Connection> makeLwsConnection(LwsConnectionOptions options) {
  return std::make_unique<LwsConnection>(std::move(options));
}

}  // namespace limn
