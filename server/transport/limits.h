// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/limits.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace limn {

/// What one client, and all of them, may take. Sessions bound what is sent (SessionOptions).
struct TransportLimits {
  std::size_t maxClients = 10'000;        // lowered to what the limit of open files allows
  std::size_t maxClientsPerAddress = 64;  // 0: no limit
  std::int64_t handshakeMs = 10'000;      // from a connection to its Hello, or its HTTP request
  std::size_t maxMessageBytes = limits::kMaxClientMessageBytes;
  std::uint32_t messagesPerSecond = 1000;  // and one more for each KiB sent to the client
  std::int64_t progressMs = 30'000;        // a client that takes nothing for so long is let go
};

/// Why somebody is turned away at the door.
enum class Refusal : std::uint8_t { kTotal, kAddress, kDraining, kToken, kOrigin, kRequest };

/// For metrics and logs: "total", "address", …
[[nodiscard]] const char* nameOf(Refusal refusal);

/// How a connection ended.
enum class Ending : std::uint8_t {
  kLeft,      // the client closed it, or the network did
  kProtocol,  // a message that is none, or not legal
  kTooLarge,  // a message over the limit
  kTooMany,   // messages over the limit
  kLate,      // no Hello in time
  kStalled,   // took nothing for too long
  kDrained,   // the server goes down
};

/// For metrics and logs: "left", "protocol", …
[[nodiscard]] const char* nameOf(Ending ending);

/// What is counted as one address: an IPv4 address, the first 64 bits of an IPv6 address (which one
/// subscriber has to himself), anything else as it is.
[[nodiscard]] std::string addressKey(std::string_view address);

/// Counts connections, in all and by address.
class ConnectionCounter {
 public:
  /// Why one more from there is too many. 0 for perAddress: no limit.
  [[nodiscard]] std::optional<Refusal>
  full(const std::string& address, std::size_t inAll, std::size_t perAddress) const;
  void enter(const std::string& address);
  void leave(const std::string& address);

  [[nodiscard]] std::size_t total() const { return total_; }

 private:
  std::unordered_map<std::string, std::size_t> byAddress_;
  std::size_t total_ = 0;
};

}  // namespace limn
