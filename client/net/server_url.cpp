// SPDX-License-Identifier: Apache-2.0
#include "client/net/server_url.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>

namespace limn {
namespace {

tl::unexpected<Error> bad(std::string_view url, const char* why) {
  return fail(
      ErrorCode::kInvalidArgument,
      "\"" + std::string(url) + "\" " + why +
          ": write ws://HOST:PORT, for instance ws://127.0.0.1:8600");
}

// An address with or without a zone ("fe80::1%eth0").
bool isIpv6(const std::string& host) {
  in6_addr address;
  return inet_pton(AF_INET6, host.substr(0, host.find('%')).c_str(), &address) == 1;
}

}  // namespace

std::string ServerUrl::text() const {
  const bool bracket = host.find(':') != std::string::npos;
  return (tls ? "wss://" : "ws://") + (bracket ? "[" + host + "]" : host) + ":" +
         std::to_string(port) + (path == "/" ? "" : path);
}

Result<ServerUrl> parseServerUrl(std::string_view url) {
  ServerUrl result;
  std::string_view rest = url;
  if (rest.starts_with("ws://")) {
    rest.remove_prefix(5);
  } else if (rest.starts_with("wss://")) {
    rest.remove_prefix(6);
    result.tls = true;
  } else {
    return bad(url, "does not start with ws:// or wss://");
  }
  const bool odd = std::any_of(url.begin(), url.end(), [](char c) {
    return static_cast<unsigned char>(c) <= ' ' || static_cast<unsigned char>(c) >= 0x7F ||
           c == '@' || c == '#';
  });
  if (odd) return bad(url, "has a character that an address cannot have");
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  if (slash < rest.size()) result.path = std::string(rest.substr(slash));
  std::string_view authority = rest.substr(0, slash);
  std::string_view port;
  if (authority.starts_with('[')) {
    const std::size_t end = authority.find(']');
    if (end == std::string_view::npos) return bad(url, "lacks a ]");
    result.host = std::string(authority.substr(1, end - 1));
    if (!isIpv6(result.host)) return bad(url, "has between [ and ] what is no IPv6 address");
    authority.remove_prefix(end + 1);
    if (!authority.empty() && authority[0] != ':') return bad(url, "has something after the ]");
    if (!authority.empty()) port = authority.substr(1);
    if (authority == ":") return bad(url, "has no port after the colon");
  } else {
    const std::size_t colon = std::min(authority.find(':'), authority.size());
    result.host = std::string(authority.substr(0, colon));
    if (result.host.find_first_of("[]") != std::string::npos) {
      return bad(url, "has a bracket in its host");
    }
    if (colon < authority.size()) {
      port = authority.substr(colon + 1);
      if (port.empty()) return bad(url, "has no port after the colon");
    }
  }
  if (result.host.empty()) return bad(url, "has no host");
  result.port = result.tls ? 443 : 80;
  if (!port.empty()) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), value);
    if (error != std::errc{} || end != port.data() + port.size() || value == 0 || value > 65535) {
      return bad(url, "has a port that is not 1 to 65535");
    }
    result.port = static_cast<std::uint16_t>(value);
  }
  return result;
}

}  // namespace limn
