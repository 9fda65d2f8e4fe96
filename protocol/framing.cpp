// SPDX-License-Identifier: Apache-2.0
#include "protocol/framing.h"

#include "protocol/limits.h"

#include "shared/core/assert.h"

namespace limn::protocol {

namespace {
constexpr std::size_t kLengthBytes = 4;
}

void appendFrame(std::vector<std::uint8_t>& section, std::span<const std::uint8_t> message) {
  LIMN_ASSERT(message.size() <= limits::kMaxServerMessageBytes);
  const auto length = static_cast<std::uint32_t>(message.size());
  for (std::size_t i = 0; i < kLengthBytes; ++i) {
    section.push_back(static_cast<std::uint8_t>(length >> (8 * i)));
  }
  section.insert(section.end(), message.begin(), message.end());
}

Result<std::optional<std::span<const std::uint8_t>>> FrameReader::next() {
  if (rest_.empty()) return std::nullopt;
  if (rest_.size() < kLengthBytes)
    return fail(ErrorCode::kCorrupt, "section cut short in a length");
  std::uint32_t length = 0;
  for (std::size_t i = 0; i < kLengthBytes; ++i)
    length |= std::uint32_t{rest_[i]} << (8 * i);
  if (length > limits::kMaxServerMessageBytes) {
    return fail(ErrorCode::kCorrupt, "section has a message longer than the largest allowed");
  }
  if (length > rest_.size() - kLengthBytes) {
    return fail(ErrorCode::kCorrupt, "section cut short in a message");
  }
  const auto message = rest_.subspan(kLengthBytes, length);
  rest_ = rest_.subspan(kLengthBytes + length);
  return message;
}

}  // namespace limn::protocol
