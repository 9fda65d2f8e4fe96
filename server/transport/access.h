// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/grant.h"
#include "server/transport/tokens.h"

#include "shared/core/result.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// Who may connect, and what they may see. Pure.
struct AccessRules {
  std::vector<std::string> tokens;   // each lets everything be seen
  std::vector<TokenKey> keys;        // sign tokens that say what may be seen, and until when
  std::vector<std::string> origins;  // hosts that browser pages may come from

  /// Whether a token is asked for.
  [[nodiscard]] bool guarded() const { return !tokens.empty() || !keys.empty(); }

  /// authorization: the header, "Bearer TOKEN". nowS: seconds since 1970. What its sender may see;
  /// nullptr for everything. Errors: as verifyToken(), in words for the sender.
  [[nodiscard]] Result<std::shared_ptr<const Grant>> admit(
      std::string_view authorization,
      std::int64_t nowS) const;

  /// origin: the header, empty for clients that are no browsers. host: the Host header. A page of
  /// our own host may connect if that is an address or localhost; a name must be in `origins`, for
  /// its owner can point any name at us (DNS rebinding).
  [[nodiscard]] bool allowsOrigin(std::string_view origin, std::string_view host) const;
};

/// One token a line; empty lines and those that start with # are left out.
/// Errors: kInvalidArgument (no token, or one that is shorter than 16 or longer than 512 bytes, or
/// has blanks or control characters), naming the line.
[[nodiscard]] Result<std::vector<std::string>> parseTokens(std::string_view text);

/// HOST:PORT, [IPV6]:PORT or :PORT (every interface).
struct ListenAddress {
  std::string host;  // numeric, without brackets; empty: every interface
  int port = 0;      // 0: any free one
  bool ipv6 = false;
};

/// Errors: kInvalidArgument, with what to write.
[[nodiscard]] Result<ListenAddress> parseListenAddress(std::string_view text);

}  // namespace limn
