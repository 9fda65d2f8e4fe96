// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace limn {

/// Who may connect. Pure; compares tokens in constant time.
struct AccessRules {
  std::vector<std::string> tokens;   // empty: no token asked for
  std::vector<std::string> origins;  // hosts that browser pages may come from, besides our own
  std::size_t maxClients = 10'000;
  std::size_t maxClientsPerAddress = 64;  // 0: no limit

  /// authorization: the header, "Bearer TOKEN". True without tokens.
  [[nodiscard]] bool hasToken(std::string_view authorization) const;
  /// origin: the header, empty for clients that are no browsers. host: the Host header.
  [[nodiscard]] bool allowsOrigin(std::string_view origin, std::string_view host) const;
};

/// One token a line; empty lines and those that start with # are left out.
/// Errors: kInvalidArgument (no token, or one that is shorter than 16 or longer than 512 bytes, or
/// has blanks or control characters), naming the line.
[[nodiscard]] Result<std::vector<std::string>> parseTokens(std::string_view text);

/// Counts connections, in all and by address.
class ConnectionCounter {
 public:
  /// False, and nothing counted, when a limit is reached.
  [[nodiscard]] bool enter(const std::string& address, const AccessRules& rules);
  void leave(const std::string& address);

  [[nodiscard]] std::size_t total() const { return total_; }

 private:
  std::unordered_map<std::string, std::size_t> byAddress_;
  std::size_t total_ = 0;
};

/// HOST:PORT, [IPV6]:PORT or :PORT (every interface).
struct ListenAddress {
  std::string host;  // numeric, without brackets; empty: every interface
  int port = 0;      // 0: any free one
  bool ipv6 = false;
};

/// Errors: kInvalidArgument, with what to write.
[[nodiscard]] Result<ListenAddress> parseListenAddress(std::string_view text);

}  // namespace limn
