// SPDX-License-Identifier: Apache-2.0
#include "server/transport/http_routes.h"

#include "server/transport/metrics.h"

#include "protocol/handshake.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

namespace limn {
namespace {

using nlohmann::json;

constexpr std::array kStateNames = {"queued", "preparing", "ready", "failed"};

std::string dump(const json& value) {
  return value.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

HttpReply text(int status, std::string body) {
  return {status, "text/plain; charset=utf-8", std::move(body)};
}

const char* phraseOf(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 426:
      return "Upgrade Required";
    case 429:
      return "Too Many Requests";
    case 503:
      return "Service Unavailable";
    default:
      return "Error";
  }
}

HttpReply notFound(std::string_view path, const char* known) {
  return text(404, "no " + std::string(path.substr(0, 100)) + " here; there is " + known + "\n");
}

}  // namespace

std::string httpText(const HttpReply& reply) {
  std::string text = "HTTP/1.1 " + std::to_string(reply.status) + " " + phraseOf(reply.status) +
                     "\r\ncontent-type: " + reply.contentType +
                     "\r\ncontent-length: " + std::to_string(reply.body.size()) + "\r\n";
  for (const auto& [name, value] : reply.headers)
    text += name + ": " + value + "\r\n";
  if (reply.close) text += "connection: close\r\n";
  return text + "\r\n" + reply.body;
}

HttpReply refusalReply(Refusal refusal, const std::string& why) {
  HttpReply reply = text(400, why + "\n");
  reply.close = true;
  switch (refusal) {
    case Refusal::kTotal:
    case Refusal::kDraining:
      reply.status = 503;
      reply.headers = {{"retry-after", "2"}};
      break;
    case Refusal::kAddress:
      reply.status = 429;
      reply.headers = {{"retry-after", "10"}};
      break;
    case Refusal::kToken:
      reply.status = 401;
      reply.headers = {{"www-authenticate", "Bearer"}};
      break;
    case Refusal::kOrigin:
      reply.status = 403;
      break;
    case Refusal::kRequest:
      break;
  }
  return reply;
}

std::optional<HttpReply> refuseUpgrade(const UpgradeRequest& request) {
  if (request.version != "13") {
    HttpReply reply = refusalReply(Refusal::kRequest, "send Sec-WebSocket-Version: 13");
    reply.status = 426;
    reply.headers = {{"sec-websocket-version", "13"}, {"upgrade", "websocket"}};
    return reply;
  }
  // 16 bytes in base64.
  const auto isDigit = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' ||
           c == '/';
  };
  if (request.key.size() != 24 || !request.key.ends_with("==") ||
      !std::ranges::all_of(request.key.substr(0, 22), isDigit)) {
    return refusalReply(Refusal::kRequest, "send a Sec-WebSocket-Key of 16 bytes in base64");
  }
  if (protocol::offersSubprotocol(request.protocols)) return std::nullopt;
  return refusalReply(
      Refusal::kRequest,
      std::string("send Sec-WebSocket-Protocol: ") + limits::kSubprotocol);
}

std::string catalogueJson(const std::vector<CatalogueItem>& items, const Grant* grant) {
  json list = json::array();
  for (const CatalogueItem& item : items) {
    if (grant != nullptr && !grant->allows(item.name)) continue;
    json entry = {
        {"name", item.name},
        {"state", kStateNames[static_cast<std::size_t>(item.state)]},
        {"progress", item.progress},
        {"reason", item.reason},
        {"asset", item.asset ? json(toHex(*item.asset)) : json()},
        {"vertices", item.vertices},
        {"faces", item.faces},
        {"bytes", item.bytes},
        {"center", {item.center.x, item.center.y, item.center.z}},
        {"radius", item.radius},
        {"has_hull", item.hasHull}};
    list.push_back(std::move(entry));
  }
  return dump(list);
}

HttpReply routeMain(
    std::string_view path,
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items,
    const Grant* grant) {
  if (path == "/models") return {200, "application/json", catalogueJson(items, grant)};
  if (path == "/livez") return text(200, "ok\n");
  if (path == "/readyz") {
    return status.ready ? text(200, "ok\n") : text(503, status.notReadyBecause + "\n");
  }
  if (path == "/version") {
    return {200, "application/json", dump({{"name", "limn-server"}, {"version", status.version}})};
  }
  return notFound(path, "/models, /livez, /readyz and /version");
}

HttpReply routeMetrics(
    std::string_view path,
    const ServerStatus& status,
    const std::vector<CatalogueItem>& items) {
  if (path == "/metrics") {
    return {200, "text/plain; version=0.0.4; charset=utf-8", metricsText(status, items)};
  }
  if (path == "/livez") return text(200, "ok\n");
  return notFound(path, "/metrics and /livez");
}

}  // namespace limn
