// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/preprocess/hulls/hulls.h"

#include "protocol/messages.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace limn {

/// The wire sections of an asset's hulls, framed messages for channel 0, and what ModelInfo says.
struct HullSections {
  std::vector<std::uint8_t> outer;  // one Hull, then HullSplits in order; empty: no hull
  std::vector<std::uint8_t> inner;
  protocol::HullInfo info;  // its reason is a view of `reason`
  std::string reason;
};

/// A hull that cannot be coded is none, with the reason. Cost: about 2 µs a split.
[[nodiscard]] std::unique_ptr<const HullSections> encodeHullSections(const Hulls& hulls);

}  // namespace limn
