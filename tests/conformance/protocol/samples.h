// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/messages.h"

#include <cstdint>
#include <string>
#include <vector>

namespace limn::protocol {

/// One message of every type with every field set, as protocol/vectors/v1 freezes it.
struct Sample {
  std::string file;  // in protocol/vectors/v1
  Sender sender = Sender::kClient;
  std::vector<std::uint8_t> bytes;
};

[[nodiscard]] std::vector<Sample> samples();

}  // namespace limn::protocol
