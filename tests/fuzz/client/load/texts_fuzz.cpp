// SPDX-License-Identifier: Apache-2.0
//
// Any text as a script of limn-load and as a server's address.
#include "client/load/script.h"
#include "client/net/server_url.h"

#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto script = limn::load::parseScript(text, "/nonexistent");
      !script && script.error().message.empty()) {
    std::abort();
  }
  if (const auto url = limn::parseServerUrl(text)) {
    if (!limn::parseServerUrl(url->text())) std::abort();
  }
  return 0;
}
