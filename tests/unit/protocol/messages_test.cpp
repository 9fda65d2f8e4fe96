// SPDX-License-Identifier: Apache-2.0
#include "protocol/messages.h"

#include "tests/conformance/protocol/samples.h"

#include "protocol/limits.h"

#include <gtest/gtest.h>

#include <limits>

namespace limn::protocol {
namespace {

template <class T>
Result<Message> roundTrip(const T& message, Sender sender) {
  static std::vector<std::uint8_t> bytes;
  bytes = encodeMessage(message);
  return decodeMessage(bytes, sender);
}

ModelInfo smallModel() {
  ModelInfo info;
  info.name = "cube";
  info.vertices = 8;
  info.faces = 12;
  info.levelBegin = {0, 4, 6, 8};
  info.blockLevels = 1;
  info.radius = 1.0;
  return info;
}

bool refuses(const Body& body, Sender sender) {
  const auto bytes = encodeMessage(body);
  return !decodeMessage(bytes, sender).has_value();
}

TEST(Messages, KeepEveryFieldOfAPose) {
  Pose pose;
  pose.channel = 9;
  pose.id = 4'000'000'000;
  pose.eye = {1.0 / 3.0, -1e6, 1e-9};
  pose.forward = {0.1, 0.2, 0.3};
  pose.up = {0.0, 0.0, 1.0};
  pose.fovY = 1.25F;
  pose.orthoHeight = 0.125;
  pose.width = 16384;
  pose.height = 1;
  pose.errorPx = 64.0F;
  pose.silhouette = Silhouette::kEdges;
  pose.goal = Goal::kComplete;
  const auto message = roundTrip(pose, Sender::kClient);
  ASSERT_TRUE(message) << message.error().message;
  const Pose& back = *message->as<Pose>();
  EXPECT_EQ(back.channel, pose.channel);
  EXPECT_EQ(back.id, pose.id);
  EXPECT_EQ(back.eye, pose.eye);
  EXPECT_EQ(back.forward, pose.forward);
  EXPECT_EQ(back.up, pose.up);
  EXPECT_EQ(back.fovY, pose.fovY);
  EXPECT_EQ(back.orthoHeight, pose.orthoHeight);
  EXPECT_EQ(back.width, pose.width);
  EXPECT_EQ(back.height, pose.height);
  EXPECT_EQ(back.errorPx, pose.errorPx);
  EXPECT_EQ(back.silhouette, pose.silhouette);
  EXPECT_EQ(back.goal, pose.goal);
}

TEST(Messages, ByteFieldsAreViewsOfTheInput) {
  const std::vector<std::uint8_t> splits(1000, 7);
  const auto bytes = encodeMessage(Packet{0, 1, splits});
  const auto message = decodeMessage(bytes, Sender::kServer);
  ASSERT_TRUE(message);
  const Bytes view = message->as<Packet>()->splits;
  EXPECT_EQ(view.size(), splits.size());
  EXPECT_GE(view.data(), bytes.data());
  EXPECT_LE(view.data() + view.size(), bytes.data() + bytes.size());
}

TEST(Messages, DecodeAtEveryAlignment) {
  for (const Sample& sample : samples()) {
    for (std::size_t offset = 0; offset < 8; ++offset) {
      std::vector<std::uint8_t> shifted(offset, 0xEE);
      shifted.insert(shifted.end(), sample.bytes.begin(), sample.bytes.end());
      auto message = decodeMessage(Bytes(shifted).subspan(offset), sample.sender);
      ASSERT_TRUE(message) << sample.file << " at " << offset;
      const Message moved = std::move(*message);
      EXPECT_EQ(encodeMessage(moved.body), sample.bytes) << sample.file;
    }
  }
}

TEST(Messages, EveryTruncationIsRefused) {
  for (const Sample& sample : samples()) {
    for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
      // A buffer of exactly that size, so that a sanitizer sees a read past it.
      const std::vector<std::uint8_t> cut(
          sample.bytes.begin(),
          sample.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      const auto message = decodeMessage(cut, sample.sender);
      if (message) {
        // Only trailing padding may be missing: then the content is whole.
        EXPECT_EQ(encodeMessage(message->body), sample.bytes) << sample.file << " cut to " << size;
        EXPECT_LT(sample.bytes.size() - size, 8U) << sample.file;
      } else {
        EXPECT_EQ(message.error().code, ErrorCode::kProtocol) << sample.file;
      }
    }
  }
}

TEST(Messages, AreRefusedFromTheWrongSide) {
  for (const Sample& sample : samples()) {
    const Sender other = sample.sender == Sender::kClient ? Sender::kServer : Sender::kClient;
    EXPECT_FALSE(decodeMessage(sample.bytes, other)) << sample.file;
  }
}

TEST(Messages, LongerThanTheLimitAreRefused) {
  const std::vector<std::uint8_t> ids(limits::kMaxClientMessageBytes, 1);
  const auto bytes = encodeMessage(Drop{0, ids});
  const auto message = decodeMessage(bytes, Sender::kClient);
  ASSERT_FALSE(message);
  EXPECT_EQ(message.error().code, ErrorCode::kLimitExceeded);
}

TEST(Messages, PosesThatAreNoCameraAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto refusesWith = [](auto change) {
    Pose pose;
    change(pose);
    return refuses(pose, Sender::kClient);
  };
  EXPECT_FALSE(refusesWith([](Pose&) {}));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.eye.x = kNan; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.forward.z = kInf; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.forward = {0.0, 0.0, 0.0}; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.up = p.forward * -2.0; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.fovY = 0.0F; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.fovY = 3.2F; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.fovY = std::nanf(""); }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.orthoHeight = -1.0; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.width = 0; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.height = 16385; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.errorPx = 0.05F; }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.errorPx = std::nanf(""); }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.goal = static_cast<Goal>(3); }));
  EXPECT_TRUE(refusesWith([](Pose& p) { p.silhouette = static_cast<Silhouette>(2); }));
}

TEST(Messages, ModelInfosThatPromiseNonsenseAreRefused) {
  const auto refusesWith = [](auto change) {
    ModelInfo info = smallModel();
    change(info);
    return refuses(info, Sender::kServer);
  };
  EXPECT_FALSE(refusesWith([](ModelInfo&) {}));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.levelBegin = {0}; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.levelBegin = {1, 4, 6, 8}; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.levelBegin = {0, 4, 4, 8}; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.levelBegin = {0, 4, 6, 9}; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) {
    m.vertices = limits::kMaxVertices + 1;
    m.levelBegin.back() = m.vertices;
  }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) {
    m.vertices = limits::kMaxBaseVertices + 2;
    m.levelBegin = {0, m.vertices - 1, m.vertices};
  }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.faces = 0; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.faces = 1000; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.blockLevels = 3; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.seedBytes = limits::kMaxSeedBytes + 1; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.gridStep = 0.0; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.gridStep = HUGE_VAL; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.gridBits = 19; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.placement = 2; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.radius = -1.0; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.name = "a/b"; }));
  EXPECT_TRUE(refusesWith([](ModelInfo& m) { m.levelBegin.assign(70, 1); }));
}

TEST(Messages, NamesThatCouldDoHarmAreRefused) {
  EXPECT_TRUE(isValidModelName("stanford dragon (vrip) – 14 bit"));
  EXPECT_FALSE(isValidModelName(""));
  EXPECT_FALSE(isValidModelName(std::string(201, 'a')));
  EXPECT_FALSE(isValidModelName("../etc"));
  EXPECT_FALSE(isValidModelName("line\nbreak"));
  EXPECT_FALSE(isValidModelName("\x1b[2J"));
  EXPECT_FALSE(isValidModelName("\xff\xfe"));
  EXPECT_FALSE(isValidModelName("\xc0\xaf"));      // overlong '/'
  EXPECT_FALSE(isValidModelName("\xed\xa0\x80"));  // surrogate
  EXPECT_FALSE(isValidModelName("cut \xe2\x82"));
  EXPECT_TRUE(refuses(Open{0, "a\tb", false}, Sender::kClient));
  EXPECT_TRUE(refuses(Hello{1, std::string(300, 'x')}, Sender::kClient));
}

TEST(Messages, HaveSetsPastTheLargestVertexAreRefused) {
  const std::vector<std::uint8_t> piece(16, 0xFF);
  EXPECT_FALSE(
      refuses(HaveSet{0, {}, true, limits::kMaxVertices - 128, piece, true}, Sender::kClient));
  EXPECT_TRUE(
      refuses(HaveSet{0, {}, true, limits::kMaxVertices - 64, piece, true}, Sender::kClient));
  EXPECT_TRUE(refuses(HaveSet{0, {}, true, 3, piece, true}, Sender::kClient));
  const std::vector<std::uint8_t> large(limits::kMaxHaveSetPieceBytes + 1, 0);
  EXPECT_TRUE(refuses(HaveSet{0, {}, true, 0, large, true}, Sender::kClient));
}

TEST(Messages, SeedPiecesPastTheirTotalAreRefused) {
  const std::vector<std::uint8_t> piece(16, 1);
  EXPECT_FALSE(refuses(Seeds{0, piece, 0, 0}, Sender::kServer));
  EXPECT_FALSE(refuses(Seeds{0, piece, 84, 100}, Sender::kServer));
  EXPECT_TRUE(refuses(Seeds{0, piece, 85, 100}, Sender::kServer));
  EXPECT_TRUE(refuses(Seeds{0, piece, 0xFFFFFFF8, 100}, Sender::kServer));
  EXPECT_TRUE(refuses(Seeds{0, piece, 16, 0}, Sender::kServer));
  EXPECT_TRUE(refuses(Seeds{0, {}, 0, 100}, Sender::kServer));
  EXPECT_TRUE(refuses(Seeds{0, piece, 0, limits::kMaxSeedBytes + 1}, Sender::kServer));
  EXPECT_TRUE(
      refuses(HaveSet{0, {}, true, 0, {}, true, limits::kMaxSeedBytes + 1}, Sender::kClient));
}

TEST(Messages, OnlyModelDataAndContoursCountAsPayload) {
  for (const Sample& sample : samples()) {
    const auto message = decodeMessage(sample.bytes, sample.sender);
    const std::string_view name = nameOf(message->body);
    const bool expected = name == "Base" || name == "LevelBlock" || name == "Packet" ||
                          name == "Seeds" || name == "Hull" || name == "HullSplits" ||
                          name == "Map" || name == "Contour";
    EXPECT_EQ(isPayload(message->body), expected) << name;
  }
}

}  // namespace
}  // namespace limn::protocol
