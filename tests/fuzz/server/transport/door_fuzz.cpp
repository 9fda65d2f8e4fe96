// SPDX-License-Identifier: Apache-2.0
//
// Any text as what strangers and operators give the server's door: tokens, key files, headers,
// addresses. The first byte says which.
#include "server/transport/access.h"
#include "server/transport/http_routes.h"
#include "server/transport/tokens.h"

#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limn;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  static const std::vector<TokenKey> kKeys = {{"main", "0123456789abcdef0123456789abcdef"}};
  switch (data[0] % 7) {
    case 0:
      // Nobody guesses a signature.
      if (verifyToken(text, kKeys, 0)) std::abort();
      break;
    case 1: {
      // What is signed may still be any claims: it is judged, not trusted.
      TokenClaims claims;
      claims.grant.subject = text;
      claims.grant.models = {std::string(text)};
      claims.expiresS = static_cast<std::int64_t>(size);
      const std::string token = signToken(claims, kKeys[0]);
      const auto grant = verifyToken(token, kKeys, 0);
      if (!grant && token.size() <= kMaxTokenBytes) std::abort();
      if (grant) static_cast<void>(grant->allows(text));
      break;
    }
    case 2:
      static_cast<void>(parseTokenKeys(text));
      break;
    case 3:
      static_cast<void>(parseTokens(text));
      break;
    case 4:
      static_cast<void>(parseListenAddress(text));
      static_cast<void>(addressKey(text));
      break;
    case 5: {
      AccessRules rules;
      rules.origins = {"viewer.example"};
      const std::size_t half = text.size() / 2;
      static_cast<void>(rules.allowsOrigin(text.substr(0, half), text.substr(half)));
      break;
    }
    default: {
      const std::size_t third = text.size() / 3;
      static_cast<void>(refuseUpgrade(
          {text.substr(0, third), text.substr(third, third), text.substr(2 * third)}));
      static_cast<void>(httpText(routeMain(text, {}, {})));
    }
  }
  return 0;
}
