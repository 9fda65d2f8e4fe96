// SPDX-License-Identifier: Apache-2.0
#include "server/transport/access.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>

namespace limn {
namespace {

/// Takes the same time whatever `given` is, so that a token cannot be guessed byte by byte.
bool sameText(std::string_view given, std::string_view secret) {
  unsigned difference = given.size() == secret.size() ? 0 : 1;
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const auto byte = static_cast<unsigned char>(i < given.size() ? given[i] : '\0');
    difference |= byte ^ static_cast<unsigned char>(secret[i]);
  }
  return difference == 0;
}

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

}  // namespace

bool AccessRules::hasToken(std::string_view authorization) const {
  if (tokens.empty()) return true;
  constexpr std::string_view kScheme = "Bearer ";
  if (!authorization.starts_with(kScheme)) return false;
  authorization.remove_prefix(kScheme.size());
  bool found = false;
  for (const std::string& token : tokens)
    found |= sameText(authorization, token);
  return found;
}

bool AccessRules::allowsOrigin(std::string_view origin, std::string_view host) const {
  if (origin.empty()) return true;
  const std::string_view page = hostOf(origin);
  if (!page.empty() && sameHost(page, hostOf(host))) return true;
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

bool ConnectionCounter::enter(const std::string& address, const AccessRules& rules) {
  if (total_ >= rules.maxClients) return false;
  std::size_t& mine = byAddress_[address];
  if (rules.maxClientsPerAddress != 0 && mine >= rules.maxClientsPerAddress) return false;
  ++mine;
  ++total_;
  return true;
}

void ConnectionCounter::leave(const std::string& address) {
  const auto found = byAddress_.find(address);
  if (found == byAddress_.end()) return;
  --total_;
  if (--found->second == 0) byAddress_.erase(found);
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
