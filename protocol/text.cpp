// SPDX-License-Identifier: Apache-2.0
#include "protocol/text.h"

#include <cstdint>

namespace limn::protocol {
namespace {

/// Whether the text is UTF-8 and all its characters are `fine`.
template <class Fine>
bool allCharacters(std::string_view text, Fine fine) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto first = static_cast<std::uint8_t>(text[i++]);
    if (first < 0x80) {
      if (!fine(std::uint32_t{first})) return false;
      continue;
    }
    // RFC 3629: length by the first byte, no overlong forms, no surrogates, nothing past U+10FFFF.
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
    if (first < 0xC2 || first > 0xF4) return false;
    std::uint32_t code = first & (0x3FU >> more);
    for (int k = 0; k < more; ++k) {
      if (i == text.size()) return false;
      const auto next = static_cast<std::uint8_t>(text[i++]);
      if ((next & 0xC0U) != 0x80U) return false;
      code = (code << 6) | (next & 0x3FU);
    }
    const std::uint32_t least = more == 3 ? 0x10000 : more == 2 ? 0x800 : 0x80;
    if (code < least || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return false;
    if (!fine(code)) return false;
  }
  return true;
}

}  // namespace

bool isUtf8(std::string_view text) {
  return allCharacters(text, [](std::uint32_t) { return true; });
}

bool isText(std::string_view text, std::size_t maxBytes) {
  // Neither C0 nor C1 control characters.
  return text.size() <= maxBytes && allCharacters(text, [](std::uint32_t code) {
           return code >= 0x20 && (code < 0x7F || code >= 0xA0);
         });
}

}  // namespace limn::protocol
