// SPDX-License-Identifier: Apache-2.0
#include "server/transport/limits.h"

#include <arpa/inet.h>

#include <array>

namespace limn {

const char* nameOf(Refusal refusal) {
  constexpr std::array kNames = {"total", "address", "draining", "token", "origin", "request"};
  return kNames[static_cast<std::size_t>(refusal)];
}

const char* nameOf(Ending ending) {
  constexpr std::array kNames =
      {"left", "protocol", "too_large", "too_many", "late", "stalled", "drained"};
  return kNames[static_cast<std::size_t>(ending)];
}

std::string addressKey(std::string_view address) {
  const std::string text(address);
  in6_addr v6{};
  if (inet_pton(AF_INET6, text.c_str(), &v6) != 1) return text;
  std::array<char, INET6_ADDRSTRLEN> buffer{};
  if (IN6_IS_ADDR_V4MAPPED(&v6)) {
    inet_ntop(AF_INET, &v6.s6_addr[12], buffer.data(), buffer.size());
    return buffer.data();
  }
  for (std::size_t i = 8; i < 16; ++i)
    v6.s6_addr[i] = 0;
  inet_ntop(AF_INET6, &v6, buffer.data(), buffer.size());
  return std::string(buffer.data()) + "/64";
}

std::optional<Refusal> ConnectionCounter::full(
    const std::string& address,
    std::size_t inAll,
    std::size_t perAddress) const {
  if (total_ >= inAll) return Refusal::kTotal;
  if (perAddress == 0) return std::nullopt;
  const auto mine = byAddress_.find(address);
  if (mine != byAddress_.end() && mine->second >= perAddress) return Refusal::kAddress;
  return std::nullopt;
}

void ConnectionCounter::enter(const std::string& address) {
  ++byAddress_[address];
  ++total_;
}

void ConnectionCounter::leave(const std::string& address) {
  const auto found = byAddress_.find(address);
  if (found == byAddress_.end()) return;
  --total_;
  if (--found->second == 0) byAddress_.erase(found);
}

}  // namespace limn
