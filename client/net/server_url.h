// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace limn {

/// Where a server listens.
struct ServerUrl {
  std::string host;  // name or address; IPv6 without its brackets
  std::uint16_t port = 0;
  std::string path = "/";
  bool tls = false;

  /// As a user would type it.
  [[nodiscard]] std::string text() const;
};

/// Parses ws://HOST[:PORT][/PATH] and wss://…; ports 80 and 443 unless given.
/// Errors: kInvalidArgument, with an example.
[[nodiscard]] Result<ServerUrl> parseServerUrl(std::string_view url);

}  // namespace limn
