// SPDX-License-Identifier: Apache-2.0
#include "client/net/http_get.h"

#include "client/net/lws_client.h"

#include <libwebsockets.h>

#include <array>
#include <chrono>
#include <memory>
#include <optional>

namespace limn {
namespace {

constexpr auto kPatience = std::chrono::seconds(10);

/// One request on the caller's thread.
class Request {
 public:
  Request(const LwsConnectionOptions& server, const std::string& path, std::size_t maxBytes)
      : server_(server),
        path_(path),
        maxBytes_(maxBytes) {}

  Result<std::string> run() {
    static const lws_protocols kProtocols[] = {
        {"http", &Request::callback, 0, 0, 0, nullptr, 0},
        {nullptr, nullptr, 0, 0, 0, nullptr, 0}};
    const lws_context_creation_info info = clientContextInfo(server_, kProtocols, this);
    const std::unique_ptr<lws_context, decltype(&lws_context_destroy)> context(
        lws_create_context(&info),
        &lws_context_destroy);
    if (!context) return failed("cannot set up the network library");
    connect(context.get());
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    // Wakes lws_service() when nothing else does.
    lws_sorted_usec_list_t alarm{};
    lws_sul_schedule(
        context.get(),
        0,
        &alarm,
        [](lws_sorted_usec_list_t*) {},
        std::chrono::microseconds(kPatience).count());
    while (!done_ && std::chrono::steady_clock::now() < deadline) {
      if (lws_service(context.get(), 0) < 0) break;
    }
    lws_sul_cancel(&alarm);
    if (tooLong_) {
      return fail(ErrorCode::kLimitExceeded, "the answer of " + where() + " is too long");
    }
    if (!done_) return failed("no answer in time");
    if (!complaint_.empty()) return failed(complaint_);
    if (status_ != 200) return failed("status " + std::to_string(status_));
    return std::move(body_);
  }

 private:
  static int
  callback(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t length) {
    lws_context* context = lws_get_context(wsi);
    auto* self = context == nullptr ? nullptr : static_cast<Request*>(lws_context_user(context));
    if (self != nullptr && wsi != nullptr) {
      if (const auto result = self->on(wsi, reason, in, length)) return *result;
    }
    return lws_callback_http_dummy(wsi, reason, user, in, length);
  }

  void connect(lws_context* context) {
    const std::string host = server_.url.host + ":" + std::to_string(server_.url.port);
    lws_client_connect_info info{};
    info.context = context;
    info.address = server_.url.host.c_str();
    info.port = server_.url.port;
    info.path = path_.c_str();
    info.host = host.c_str();
    info.method = "GET";
    info.protocol = "http";
    info.alpn = "http/1.1";
    if (server_.url.tls) info.ssl_connection = LCCSCF_USE_SSL;
    if (lws_client_connect_via_info(&info) == nullptr) finish("cannot connect");
  }

  /// nullopt: as lws would by itself.
  std::optional<int> on(lws* wsi, lws_callback_reasons reason, void* in, std::size_t length) {
    switch (reason) {
      case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER:
        return addBearerToken(wsi, server_.token, in, length);
      case LWS_CALLBACK_ESTABLISHED_CLIENT_HTTP:
        status_ = static_cast<int>(lws_http_client_http_response(wsi));
        return 0;
      case LWS_CALLBACK_RECEIVE_CLIENT_HTTP_READ:
        if (body_.size() + length > maxBytes_) {
          tooLong_ = true;
          return finish({});
        }
        body_.append(static_cast<const char*>(in), length);
        return 0;
      case LWS_CALLBACK_RECEIVE_CLIENT_HTTP: {
        std::array<char, LWS_PRE + 4096> buffer{};
        char* at = buffer.data() + LWS_PRE;
        int room = static_cast<int>(buffer.size() - LWS_PRE);
        return lws_http_client_read(wsi, &at, &room) < 0 ? -1 : 0;
      }
      case LWS_CALLBACK_COMPLETED_CLIENT_HTTP:
        return finish({});
      case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
        finish(
            in == nullptr ? std::string("cannot connect")
                          : std::string(static_cast<const char*>(in), length));
        return 0;
      case LWS_CALLBACK_CLOSED_CLIENT_HTTP:
        if (!done_) finish("the connection ended early");
        return 0;
      default:
        return std::nullopt;
    }
  }

  /// Returns what closes the connection.
  int finish(std::string complaint) {
    if (!done_) complaint_ = std::move(complaint);
    done_ = true;
    return -1;
  }

  [[nodiscard]] std::string where() const { return server_.url.text() + path_; }

  [[nodiscard]] tl::unexpected<Error> failed(const std::string& why) const {
    return fail(
        ErrorCode::kNetwork,
        "cannot read " + where() + " (" + why +
            "): check the address and that limn-server runs there");
  }

  const LwsConnectionOptions& server_;
  const std::string& path_;
  const std::size_t maxBytes_;
  bool done_ = false;
  bool tooLong_ = false;
  int status_ = 0;
  std::string complaint_;
  std::string body_;
};

}  // namespace

Result<std::string>
httpGet(const LwsConnectionOptions& server, const std::string& path, std::size_t maxBytes) {
  return Request(server, path, maxBytes).run();
}

}  // namespace limn
