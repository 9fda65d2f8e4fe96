// SPDX-License-Identifier: Apache-2.0
#include "client/core/byte_counters.h"

#include "tests/conformance/protocol/samples.h"

#include "protocol/framing.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

std::uint64_t sumOfParts(const ByteCounters& b) {
  return b.base + b.levelBlocks + b.packets + b.features + b.seeds + b.hull + b.maps + b.contours +
         b.control;
}

TEST(ByteCounters, PartsAddUpToReceived) {
  ByteCounters bytes;
  std::uint64_t wire = 0;
  for (const auto& sample : protocol::samples()) {
    if (sample.sender != protocol::Sender::kServer) continue;
    const auto message = protocol::decodeMessage(sample.bytes, sample.sender);
    const std::size_t frame =
        sample.bytes.size() + protocol::webSocketHeaderBytes(sample.bytes.size());
    bytes.count(message->body, frame);
    wire += frame;
    EXPECT_EQ(bytes.received, wire);
    EXPECT_EQ(sumOfParts(bytes), wire) << sample.file;
  }
  bytes.countControl(10);
  EXPECT_EQ(sumOfParts(bytes), wire + 10);
  EXPECT_EQ(bytes.features, 5U);  // of the sample "base"
  EXPECT_GT(bytes.base, 0U);
  EXPECT_GT(bytes.levelBlocks, 0U);
  EXPECT_GT(bytes.packets, 0U);
  EXPECT_GT(bytes.seeds, 0U);
  EXPECT_GT(bytes.control, 0U);
  const ByteCounters once = bytes;
  bytes += once;
  EXPECT_EQ(bytes.received, 2 * once.received);
  EXPECT_EQ(sumOfParts(bytes), bytes.received);
}

TEST(ByteCounters, FrameHeadersAreThoseOfRfc6455) {
  EXPECT_EQ(protocol::webSocketHeaderBytes(0), 2U);
  EXPECT_EQ(protocol::webSocketHeaderBytes(125), 2U);
  EXPECT_EQ(protocol::webSocketHeaderBytes(126), 4U);
  EXPECT_EQ(protocol::webSocketHeaderBytes(65535), 4U);
  EXPECT_EQ(protocol::webSocketHeaderBytes(65536), 10U);
}

}  // namespace
}  // namespace limn
