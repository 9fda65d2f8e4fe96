// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/protocol/samples.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace limn::protocol {
namespace {

const std::filesystem::path kVectors = LIMN_VECTORS;

std::vector<std::uint8_t> readFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A changed byte is a new version of the protocol: SPEC.md first, then vectors/v2.
TEST(ProtocolVectors, EveryMessageEncodesToItsFrozenBytes) {
  for (const Sample& sample : samples()) {
    EXPECT_EQ(sample.bytes, readFile(kVectors / sample.file)) << sample.file;
  }
}

TEST(ProtocolVectors, EveryFrozenMessageDecodesAndEncodesBackToItself) {
  for (const Sample& sample : samples()) {
    const auto frozen = readFile(kVectors / sample.file);
    const auto message = decodeMessage(frozen, sample.sender);
    ASSERT_TRUE(message) << sample.file << ": " << message.error().message;
    EXPECT_EQ(encodeMessage(message->body), frozen) << sample.file;
  }
}

TEST(ProtocolVectors, EveryTypeOfMessageHasAVectorAndNoFileIsLeftOver) {
  std::set<std::size_t> types;
  std::set<std::string> files;
  for (const Sample& sample : samples()) {
    types.insert(decodeMessage(sample.bytes, sample.sender)->body.index());
    files.insert(sample.file);
  }
  EXPECT_EQ(types.size(), std::variant_size_v<Body>);
  for (const auto& entry : std::filesystem::directory_iterator(kVectors)) {
    if (entry.path().extension() != ".bin") continue;
    EXPECT_TRUE(files.contains(entry.path().filename())) << entry.path();
  }
}

}  // namespace
}  // namespace limn::protocol
