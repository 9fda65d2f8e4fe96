// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a manifest, as a name's record, as the settings beside models (limn.toml): what is
// read must survive being written.
#include "server/apps/model_folder.h"
#include "server/store/manifest.h"

#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limn;
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 3) {
    case 0: {
      const auto manifest = parseManifest(bytes);
      if (!manifest) break;
      static_cast<void>(assetFormatOf(manifest->report));
      if (!serializeManifest(*manifest)) std::abort();
      break;
    }
    case 1:
      static_cast<void>(parseNameRecord(bytes));
      static_cast<void>(isModelName(text));
      static_cast<void>(digestFromHex(text));
      if (nameFile(text).size() > 255) std::abort();
      break;
    default:
      if (const auto settings = PrepareSettings::parse(text)) {
        static_cast<void>(settings->flagsFor("dragon"));
      }
  }
  return 0;
}
