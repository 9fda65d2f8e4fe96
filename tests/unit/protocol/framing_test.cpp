// SPDX-License-Identifier: Apache-2.0
#include "protocol/framing.h"

#include <gtest/gtest.h>

namespace limn::protocol {
namespace {

std::vector<std::uint8_t> section(std::initializer_list<std::vector<std::uint8_t>> messages) {
  std::vector<std::uint8_t> bytes;
  for (const auto& message : messages)
    appendFrame(bytes, message);
  return bytes;
}

TEST(Framing, GivesBackWhatWasAppended) {
  const auto bytes = section({{1, 2, 3}, {}, {4}});
  FrameReader reader(bytes);
  std::vector<std::size_t> sizes;
  while (true) {
    const auto frame = reader.next();
    ASSERT_TRUE(frame);
    if (!*frame) break;
    sizes.push_back((*frame)->size());
  }
  EXPECT_EQ(sizes, (std::vector<std::size_t>{3, 0, 1}));
}

TEST(Framing, LengthIsLittleEndian) {
  EXPECT_EQ(section({{7, 8}}), (std::vector<std::uint8_t>{2, 0, 0, 0, 7, 8}));
}

TEST(Framing, EveryTruncationInsideAFrameIsAnError) {
  const auto bytes = section({{1, 2, 3}, {4, 5}});
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const std::vector<std::uint8_t> cut(
        bytes.begin(),
        bytes.begin() + static_cast<std::ptrdiff_t>(size));
    FrameReader reader(cut);
    bool failed = false;
    while (true) {
      const auto frame = reader.next();
      failed = !frame;
      if (failed || !*frame) break;
    }
    const bool boundary = size == 0 || size == 7 || size == bytes.size();
    EXPECT_EQ(failed, !boundary) << size;
  }
}

TEST(Framing, HostileLengthsAreRefused) {
  const std::vector<std::uint8_t> huge{0xFF, 0xFF, 0xFF, 0xFF, 1, 2, 3};
  FrameReader reader(huge);
  const auto frame = reader.next();
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::kCorrupt);
}

}  // namespace
}  // namespace limn::protocol
