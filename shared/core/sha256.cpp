// SPDX-License-Identifier: Apache-2.0
#include "shared/core/sha256.h"

#include "shared/core/assert.h"
#include "shared/core/hex.h"

#include <openssl/evp.h>

#include <memory>

namespace limn {

Sha256Digest sha256(std::span<const std::span<const std::uint8_t>> pieces) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(
      EVP_MD_CTX_new(),
      &EVP_MD_CTX_free);
  Sha256Digest digest{};
  bool ok = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (const auto piece : pieces) {
    ok = ok && EVP_DigestUpdate(context.get(), piece.data(), piece.size()) == 1;
  }
  ok = ok && EVP_DigestFinal_ex(context.get(), digest.data(), nullptr) == 1;
  LIMN_ASSERT(ok);
  if (!ok) digest.fill(0);
  return digest;
}

Sha256Digest sha256(std::span<const std::uint8_t> bytes) {
  const std::span<const std::uint8_t> pieces[] = {bytes};
  return sha256(pieces);
}

std::string toHex(const Sha256Digest& digest) {
  return hexOf(digest);
}

}  // namespace limn
