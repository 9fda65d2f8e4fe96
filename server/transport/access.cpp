// SPDX-License-Identifier: Apache-2.0
#include "server/transport/access.h"

#include "shared/core/hmac.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace limn {
namespace {

/// The host of "scheme://host:port", or of "host:port".
std::string_view hostOf(std::string_view text) {
  if (const std::size_t scheme = text.find("://"); scheme != std::string_view::npos) {
    text.remove_prefix(scheme + 3);
  }
  text = text.substr(0, text.find('/'));
  if (text.starts_with('[')) return text.substr(0, text.find(']') + 1);
  return text.substr(0, text.find(':'));
}

bool sameHost(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    return lower(x) == lower(y);
  });
}

bool isAddressOrLocal(std::string_view host) {
  if (sameHost(host, "localhost") || host.starts_with('[')) return true;
  in_addr v4{};
  return inet_pton(AF_INET, std::string(host).c_str(), &v4) == 1;
}

}  // namespace

Result<std::shared_ptr<const Grant>> AccessRules::admit(
    std::string_view authorization,
    std::int64_t nowS) const {
  if (!guarded()) return nullptr;
  constexpr std::string_view kScheme = "Bearer ";
  if (!authorization.starts_with(kScheme)) {
    return fail(ErrorCode::kProtocol, "send Authorization: Bearer TOKEN");
  }
  authorization.remove_prefix(kScheme.size());
  bool found = false;
  for (const std::string& token : tokens)
    found |= sameSecret(authorization, token);
  if (found) return nullptr;
  if (keys.empty()) return fail(ErrorCode::kProtocol, "that token is none of this server's");
  auto grant = verifyToken(authorization, keys, nowS);
  if (!grant) return tl::unexpected(grant.error());
  return std::make_shared<const Grant>(std::move(*grant));
}

bool AccessRules::allowsOrigin(std::string_view origin, std::string_view host) const {
  if (origin.empty()) return true;
  const std::string_view page = hostOf(origin);
  if (isAddressOrLocal(page) && sameHost(page, hostOf(host))) return true;
  return std::ranges::any_of(origins, [&](const std::string& allowed) {
    return sameHost(page, hostOf(allowed));
  });
}

Result<std::vector<std::string>> parseTokens(std::string_view text) {
  std::vector<std::string> tokens;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view token = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (token.ends_with('\r')) token.remove_suffix(1);
    if (token.empty() || token.starts_with('#')) continue;
    const bool printable = std::ranges::all_of(token, [](char c) { return c > ' ' && c < 0x7F; });
    if (!printable || token.size() < 16 || token.size() > 512) {
      return fail(
          ErrorCode::kInvalidArgument,
          "line " + std::to_string(line) + ": a token is 16 to 512 visible ASCII characters");
    }
    tokens.emplace_back(token);
  }
  if (tokens.empty()) return fail(ErrorCode::kInvalidArgument, "there is no token in it");
  return tokens;
}

Result<ListenAddress> parseListenAddress(std::string_view text) {
  const auto refuse = [&] {
    return fail(
        ErrorCode::kInvalidArgument,
        "'" + std::string(text) +
            "' is no address to listen on; write for example 127.0.0.1:8600, [::1]:8600 or "
            "0.0.0.0:8600");
  };
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return refuse();
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  ListenAddress address;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (error != std::errc() || end != port.data() + port.size() || port.empty() ||
      address.port < 0 || address.port > 65535) {
    return refuse();
  }
  if (host == "localhost") host = "127.0.0.1";
  if (host.starts_with('[')) {
    if (!host.ends_with(']')) return refuse();
    host = host.substr(1, host.size() - 2);
    address.ipv6 = true;
  }
  address.host = host;
  in6_addr v6{};
  in_addr v4{};
  const bool numeric = address.ipv6 ? inet_pton(AF_INET6, address.host.c_str(), &v6) == 1
                                    : inet_pton(AF_INET, address.host.c_str(), &v4) == 1;
  if (!address.host.empty() && !numeric) return refuse();
  return address;
}

}  // namespace limn
