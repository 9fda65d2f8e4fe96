// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/grant.h"

#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// Signed tokens: JSON Web Tokens [RFC 7519] of one kind, HS256, so that anybody's library can make
/// them. Header {"alg":"HS256","kid":KEY}, claims {"exp":seconds since 1970,"models":[names]} and,
/// if you like, "nbf" and "sub". Pure: the time is an argument, seconds since 1970.

/// A secret that signs tokens, and its name.
struct TokenKey {
  std::string id;
  std::string secret;
};

/// One "ID SECRET" a line; empty lines and those that start with # are left out.
/// Errors: kInvalidArgument (no key, a name used twice, a secret that is shorter than 32 or longer
/// than 512 visible ASCII characters), naming the line.
[[nodiscard]] Result<std::vector<TokenKey>> parseTokenKeys(std::string_view text);

/// A line for such a file, from the system's source of randomness. Errors: kInvalidArgument (an id
/// that is none), kUnavailable.
[[nodiscard]] Result<std::string> makeTokenKey(std::string_view id);

inline constexpr std::size_t kMaxTokenBytes = 3072;  // a request's headers have 4096

struct TokenClaims {
  Grant grant;
  std::int64_t expiresS = 0;
};

[[nodiscard]] std::string signToken(const TokenClaims& claims, const TokenKey& key);

/// The rights in a token. Errors: kInvalidArgument (not such a token), kProtocol (signed by none of
/// the keys, has expired, is not valid yet), with what to do. Total over any bytes.
[[nodiscard]] Result<Grant>
verifyToken(std::string_view token, const std::vector<TokenKey>& keys, std::int64_t nowS);

}  // namespace limn
