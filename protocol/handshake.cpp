// SPDX-License-Identifier: Apache-2.0
#include "protocol/handshake.h"

#include "protocol/limits.h"

#include <algorithm>
#include <string>

namespace limn::protocol {

bool offersSubprotocol(std::string_view header) {
  while (!header.empty()) {
    const std::size_t comma = std::min(header.find(','), header.size());
    std::string_view token = header.substr(0, comma);
    const std::size_t first = token.find_first_not_of(" \t");
    token = first == std::string_view::npos
                ? std::string_view{}
                : token.substr(first, token.find_last_not_of(" \t") - first + 1);
    if (token == limits::kSubprotocol) return true;
    header.remove_prefix(std::min(comma + 1, header.size()));
  }
  return false;
}

Result<std::uint16_t> negotiateVersion(std::uint16_t clientHighest) {
  if (clientHighest < 1) {
    return fail(
        ErrorCode::kProtocol,
        "the client speaks version " + std::to_string(clientHighest) + ", this server 1 to " +
            std::to_string(limits::kProtocolVersion));
  }
  return std::min(clientHighest, limits::kProtocolVersion);
}

Result<void> checkWelcome(std::uint16_t serverVersion) {
  if (serverVersion < 1 || serverVersion > limits::kProtocolVersion) {
    return fail(
        ErrorCode::kProtocol,
        "the server answered with version " + std::to_string(serverVersion) +
            ", this client speaks 1 to " + std::to_string(limits::kProtocolVersion));
  }
  return {};
}

}  // namespace limn::protocol
