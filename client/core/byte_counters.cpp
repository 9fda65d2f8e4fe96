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

ByteCounters& ByteCounters::operator+=(const ByteCounters& more) {
  received += more.received;
  base += more.base;
  levelBlocks += more.levelBlocks;
  packets += more.packets;
  features += more.features;
  seeds += more.seeds;
  hull += more.hull;
  maps += more.maps;
  contours += more.contours;
  control += more.control;
  return *this;
}

}  // namespace limn
