// SPDX-License-Identifier: Apache-2.0
#include "shared/core/hmac.h"

#include "shared/core/assert.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

namespace limn {

Sha256Digest hmacSha256(std::string_view key, std::string_view message) {
  Sha256Digest digest{};
  unsigned size = 0;
  const bool ok = HMAC(
                      EVP_sha256(),
                      key.data(),
                      static_cast<int>(key.size()),
                      reinterpret_cast<const unsigned char*>(message.data()),
                      message.size(),
                      digest.data(),
                      &size) != nullptr &&
                  size == digest.size();
  LIMN_ASSERT(ok);
  if (!ok) digest.fill(0);
  return digest;
}

bool sameSecret(std::string_view given, std::string_view secret) {
  unsigned difference = given.size() == secret.size() ? 0 : 1;
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const auto byte = static_cast<unsigned char>(i < given.size() ? given[i] : '\0');
    difference |= byte ^ static_cast<unsigned char>(secret[i]);
  }
  return difference == 0;
}

bool sameSecret(const Sha256Digest& given, const Sha256Digest& secret) {
  return CRYPTO_memcmp(given.data(), secret.data(), secret.size()) == 0;
}

}  // namespace limn
