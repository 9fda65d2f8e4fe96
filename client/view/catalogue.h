// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// A model as a server's catalogue lists it.
struct CatalogueEntry {
  enum class State { kQueued, kPreparing, kReady, kFailed };
  std::string name;
  State state = State::kReady;
  double progress = 1.0;  // of the preparation, 0 … 1
  std::string reason;     // kFailed
  std::uint64_t faces = 0;
};

/// Parses the answer to `GET /models`; entries with impossible names are left out.
/// Errors: kProtocol.
[[nodiscard]] Result<std::vector<CatalogueEntry>> parseCatalogue(std::string_view json);

}  // namespace limn
