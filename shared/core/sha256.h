// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace limn {

using Sha256Digest = std::array<std::uint8_t, 32>;

/// SHA-256 [FIPS 180-4] of the pieces one after another, as if they were one message.
[[nodiscard]] Sha256Digest sha256(std::span<const std::span<const std::uint8_t>> pieces);
[[nodiscard]] Sha256Digest sha256(std::span<const std::uint8_t> bytes);

/// Lower-case hexadecimal, 64 characters.
[[nodiscard]] std::string toHex(const Sha256Digest& digest);

}  // namespace limn
