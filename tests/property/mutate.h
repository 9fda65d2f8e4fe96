// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/rng.h"

#include <cstdint>
#include <cstdlib>
#include <vector>

namespace limn {

/// How many mutations a test makes: LIMN_MUTATIONS where that is set, for long runs outside CI.
inline int mutationRounds(int inCi) {
  const char* asked = std::getenv("LIMN_MUTATIONS");
  return asked != nullptr && std::atoi(asked) > 0 ? std::atoi(asked) : inCi;
}

/// One to four edits: flipped bits, overwritten bytes, lengths blown up, pieces cut out or
/// repeated.
inline std::vector<std::uint8_t> mutated(std::vector<std::uint8_t> bytes, Rng& rng) {
  const std::uint32_t edits = 1 + rng.below(4);
  for (std::uint32_t e = 0; e < edits && !bytes.empty(); ++e) {
    const std::uint32_t at = rng.below(static_cast<std::uint32_t>(bytes.size()));
    switch (rng.below(5)) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1U << rng.below(8));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(rng.below(256));
        break;
      case 2:
        bytes[at] = 0xFF;
        break;
      case 3:
        bytes.erase(bytes.begin() + at);
        break;
      default:
        bytes.insert(bytes.begin() + at, bytes[at]);
        break;
    }
  }
  // Exactly as large as its content, so that a sanitizer sees a read past it.
  bytes.shrink_to_fit();
  return bytes;
}

}  // namespace limn
