// SPDX-License-Identifier: Apache-2.0
#include "protocol/section_hash.h"

#include "shared/core/hex.h"
#include "shared/core/sha256.h"

#include <algorithm>

namespace limn::protocol {

SectionHash sectionHash(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> more) {
  const std::span<const std::uint8_t> pieces[] = {bytes, more};
  const Sha256Digest digest = sha256(pieces);
  return *toSectionHash(std::span(digest).first<16>());
}

std::optional<SectionHash> toSectionHash(std::span<const std::uint8_t> bytes) {
  SectionHash hash{};
  if (bytes.size() != hash.size()) return std::nullopt;
  std::ranges::copy(bytes, hash.begin());
  return hash;
}

std::string toHex(const SectionHash& hash) {
  return hexOf(hash);
}

}  // namespace limn::protocol
