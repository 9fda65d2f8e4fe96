// SPDX-License-Identifier: Apache-2.0
#include "protocol/text.h"

#include <cstdint>

namespace limn::protocol {

bool isText(std::string_view text, std::size_t maxBytes) {
  if (text.size() > maxBytes) return false;
  std::size_t i = 0;
  while (i < text.size()) {
    const auto first = static_cast<std::uint8_t>(text[i++]);
    if (first < 0x20 || first == 0x7F) return false;
    if (first < 0x80) continue;
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
    if (code < 0xA0) return false;  // C1 control characters
  }
  return true;
}

}  // namespace limn::protocol
