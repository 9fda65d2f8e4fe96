// SPDX-License-Identifier: Apache-2.0
#include "protocol/base_features.h"

namespace limn::protocol {
namespace {
constexpr std::uint32_t kBits = 2;
constexpr std::uint32_t kMask = (1U << kBits) - 1;
}  // namespace

std::vector<std::uint8_t> packBaseFeatures(std::span<const std::uint8_t> features) {
  std::vector<std::uint8_t> bytes;
  std::uint64_t next = 0;
  for (std::uint64_t h = 0; h < features.size(); ++h) {
    const std::uint32_t bits = features[h] & kMask;
    if (bits == 0) continue;
    std::uint64_t value = ((h - next) << kBits) | bits;
    next = h + 1;
    for (; value >= 0x80; value >>= 7)
      bytes.push_back(static_cast<std::uint8_t>(value | 0x80));
    bytes.push_back(static_cast<std::uint8_t>(value));
  }
  return bytes;
}

Result<std::vector<std::uint8_t>> unpackBaseFeatures(
    std::span<const std::uint8_t> bytes,
    std::uint32_t halfEdgeCount) {
  std::vector<std::uint8_t> features;
  if (bytes.empty()) return features;
  features.resize(halfEdgeCount, 0);
  std::uint64_t next = 0;
  std::size_t i = 0;
  while (i < bytes.size()) {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      if (i == bytes.size() || shift > 35) {
        return fail(ErrorCode::kCorrupt, "base features: a number is cut short or too long");
      }
      const std::uint8_t byte = bytes[i++];
      value |= std::uint64_t{byte & 0x7FU} << shift;
      if (byte < 0x80) break;
    }
    next += value >> kBits;
    if ((value & kMask) == 0)
      return fail(ErrorCode::kCorrupt, "base features: an entry without bits");
    if (next >= halfEdgeCount) {
      return fail(ErrorCode::kCorrupt, "base features: past the last half-edge");
    }
    features[next++] = static_cast<std::uint8_t>(value & kMask);
  }
  return features;
}

}  // namespace limn::protocol
