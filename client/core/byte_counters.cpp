// SPDX-License-Identifier: Apache-2.0
#include "client/core/byte_counters.h"

#include <algorithm>
#include <variant>

namespace limn {

void ByteCounters::count(const protocol::Body& body, std::size_t wireBytes) {
  received += wireBytes;
  if (const auto* message = std::get_if<protocol::Base>(&body)) {
    const std::uint64_t ofFeatures = std::min(message->features.size(), wireBytes);
    features += ofFeatures;
    base += wireBytes - ofFeatures;
  } else if (std::holds_alternative<protocol::LevelBlock>(body)) {
    levelBlocks += wireBytes;
  } else if (std::holds_alternative<protocol::Packet>(body)) {
    packets += wireBytes;
  } else if (std::holds_alternative<protocol::Seeds>(body)) {
    seeds += wireBytes;
  } else if (
      std::holds_alternative<protocol::Hull>(body) ||
      std::holds_alternative<protocol::HullSplits>(body)) {
    hull += wireBytes;
  } else if (std::holds_alternative<protocol::Contour>(body)) {
    contours += wireBytes;
  } else if (std::holds_alternative<protocol::Map>(body)) {
    maps += wireBytes;
  } else {
    control += wireBytes;
  }
}

void ByteCounters::countControl(std::size_t wireBytes) {
  received += wireBytes;
  control += wireBytes;
}

}  // namespace limn
