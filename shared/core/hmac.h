// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/sha256.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace limn {

/// HMAC-SHA-256 [RFC 2104, FIPS 198-1].
[[nodiscard]] Sha256Digest hmacSha256(std::string_view key, std::string_view message);

/// Whether two texts are the same, in a time that depends on the length of the second alone: a
/// secret cannot be guessed byte by byte.
[[nodiscard]] bool sameSecret(std::string_view given, std::string_view secret);
[[nodiscard]] bool sameSecret(const Sha256Digest& given, const Sha256Digest& secret);

}  // namespace limn
