// SPDX-License-Identifier: Apache-2.0
#include "server/transport/door.h"

#include "server/transport/lws_transport.h"
#include "server/transport/socket_list.h"

#include <libwebsockets.h>
#include <netdb.h>
#include <strings.h>
#include <sys/socket.h>

#include <array>
#include <ctime>
#include <utility>

namespace limn {
namespace {

constexpr std::size_t kSpareSockets = 16;  // besides clients, and as many from one address
constexpr double kLoggedRefusals = 10.0;   // a second: a flood must not fill the disk

std::string header(lws* wsi, lws_token_indexes token) {
  const int length = lws_hdr_total_length(wsi, token);
  if (length <= 0) return {};
  std::string value(static_cast<std::size_t>(length) + 1, '\0');
  const int copied = lws_hdr_copy(wsi, value.data(), length + 1, token);
  value.resize(copied > 0 ? static_cast<std::size_t>(copied) : 0);
  return value;
}

}  // namespace

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

void sayAtTheDoor(int file, int status, const std::string& why) {
  HttpReply reply{status, "text/plain; charset=utf-8", why + "\n", {}, true};
  const std::string text = httpText(reply);
  static_cast<void>(::send(file, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
}

Door::Door(const TransportOptions& options, std::function<void(const TransportEvent&)> happened)
    : options_(options),
      happened_(std::move(happened)),
      refusalLog_(kLoggedRefusals, kLoggedRefusals) {}

int Door::filter(int file) {
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

void Door::countRefusal(Refusal why, const std::string& address) {
  ++refused_[static_cast<std::size_t>(why)];
  if (!happened_ || !refusalLog_.take(LwsTransport::nowMs())) return;
  happened_({TransportEvent::Kind::kRefused, 0, address, nameOf(why)});
}

HttpReply Door::turnAway(Refusal why, const std::string& address, const std::string& text) {
  countRefusal(why, address);
  return refusalReply(why, text);
}

Result<std::shared_ptr<const Grant>> Door::grantOf(lws* wsi) const {
  return options_.access.admit(header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION), std::time(nullptr));
}

bool Door::asksForWebSocket(lws* wsi) {
  // The library answers an unknown upgrade and frees its headers, then asks all the same: what it
  // passes as the upgrade's name may be gone (NN-2025-0102).
  return lws_hdr_total_length(wsi, WSI_TOKEN_UPGRADE) > 0 &&
         strcasecmp(header(wsi, WSI_TOKEN_UPGRADE).c_str(), "websocket") == 0;
}

std::optional<HttpReply> Door::refuse(lws* wsi, Socket& socket, Port port) {
  const auto away = [&](Refusal why, const std::string& text) {
    return turnAway(why, socket.address, text);
  };
  if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0 ||
      header(wsi, WSI_TOKEN_HTTP) != "HTTP/1.1") {
    return away(Refusal::kRequest, "an upgrade is a GET of HTTP/1.1");
  }
  if (port == Port::kMetrics)
    return away(Refusal::kRequest, "there are no WebSockets on this port");
  if (port == Port::kDraining) return away(Refusal::kDraining, "the server is going down");
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

}  // namespace limn
