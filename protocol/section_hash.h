// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace limn::protocol {

/// The first half of a SHA-256: what parts of a stream are checked by before they are used, and
/// what a client keeps them under (SPEC.md, "Hashes").
using SectionHash = std::array<std::uint8_t, 16>;

/// Of both, one after the other.
[[nodiscard]] SectionHash sectionHash(
    std::span<const std::uint8_t> bytes,
    std::span<const std::uint8_t> more = {});

/// nullopt: not 16 bytes.
[[nodiscard]] std::optional<SectionHash> toSectionHash(std::span<const std::uint8_t> bytes);

/// Lower-case hexadecimal, 32 characters.
[[nodiscard]] std::string toHex(const SectionHash& hash);

}  // namespace limn::protocol
