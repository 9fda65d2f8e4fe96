// SPDX-License-Identifier: Apache-2.0
#include "client/load/light_client.h"

#include "protocol/limits.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace limn::load {
namespace {

/// Plays the server for one client, with made-up times.
class LightClientTest : public ::testing::Test {
 protected:
  LightClientTest() { phase_.model = "dragon"; }

  std::unique_ptr<LightClient> makeClient(std::uint32_t index = 0) {
    LightClient::Plan plan;
    plan.phase = &phase_;
    plan.index = index;
    plan.startMs = 100.0;
    plan.endMs = 10'000.0;
    return std::make_unique<LightClient>(std::move(plan), digests_, counters_);
  }

  static protocol::Message sent(const std::vector<std::uint8_t>& bytes) {
    auto message = protocol::decodeMessage(bytes, protocol::Sender::kClient);
    EXPECT_TRUE(message) << (message ? "" : message.error().message);
    return message ? std::move(*message) : protocol::Message{};
  }

  static void give(LightClient& client, const protocol::Body& body, double nowMs) {
    client.received(protocol::encodeMessage(body), nowMs);
  }

  /// Connects at 110 and goes on until the base mesh is there.
  void bringUp(LightClient& client, std::uint8_t baseContent = 1) {
    client.tick(110.0);
    EXPECT_EQ(client.takeWish(), LightClient::Wish::kConnect);
    client.opened(110.0);
    give(client, protocol::Welcome{limits::kProtocolVersion, "server"}, 110.0);
    give(client, info(), 110.0);
    give(client, base(baseContent), 110.0);
    static_cast<void>(client.takeOutgoing());
  }

  [[nodiscard]] protocol::ModelInfo info() const {
    protocol::ModelInfo model;
    model.name = "dragon";
    model.radius = 2.0;
    model.vertices = 8;
    model.faces = 12;
    model.levelBegin = {0, 4, 8};
    model.blockLevels = 1;
    model.splitModel = coder_;
    return model;
  }

  protocol::Base base(std::uint8_t content) {
    baseBytes_ = {content, 2, 3};
    return {0, baseBytes_, {}};
  }

  Phase phase_;
  SharedDigests digests_;
  Counters counters_;
  std::vector<std::uint8_t> coder_{1, 2, 3};
  std::vector<std::uint8_t> baseBytes_;
  std::vector<std::uint8_t> splits_{9, 9};
};

TEST_F(LightClientTest, SpeaksTheProtocolInOrder) {
  auto client = makeClient();
  EXPECT_EQ(client->nextDueMs(), 100.0);
  client->tick(100.0);
  EXPECT_EQ(client->takeWish(), LightClient::Wish::kConnect);
  client->opened(105.0);
  auto out = client->takeOutgoing();
  ASSERT_EQ(out.size(), 1u);
  EXPECT_TRUE(sent(out[0]).as<protocol::Hello>());
  give(*client, protocol::Welcome{limits::kProtocolVersion, "server"}, 110.0);
  out = client->takeOutgoing();
  ASSERT_EQ(out.size(), 1u);
  const protocol::Message open = sent(out[0]);
  ASSERT_TRUE(open.as<protocol::Open>());
  EXPECT_EQ(open.as<protocol::Open>()->model, "dragon");
  give(*client, info(), 120.0);
  give(*client, base(1), 130.0);
  out = client->takeOutgoing();
  ASSERT_EQ(out.size(), 1u);
  const protocol::Message acknowledge = sent(out[0]);
  ASSERT_TRUE(acknowledge.as<protocol::Acknowledge>());
  EXPECT_EQ(
      acknowledge.as<protocol::Acknowledge>()->bytes,
      protocol::encodeMessage(base(1)).size());
  EXPECT_EQ(counters_.connect.percentile(1.0), 10.0);
  EXPECT_EQ(counters_.base.percentile(1.0), 30.0);
  EXPECT_EQ(counters_.connected, 1u);
  EXPECT_EQ(counters_.decodeErrors, 0u);
}

TEST_F(LightClientTest, SendsPosesOnTheOrbitAtItsRate) {
  auto client = makeClient(3);
  bringUp(*client);
  client->tick(110.0 + 1000.0);  // eleven are due, and none is left out
  const auto out = client->takeOutgoing();
  ASSERT_EQ(out.size(), 11u);
  std::uint32_t id = 0;
  for (const auto& bytes : out) {
    const protocol::Message message = sent(bytes);
    const auto* pose = message.as<protocol::Pose>();
    ASSERT_NE(pose, nullptr);
    EXPECT_EQ(pose->id, ++id);
    EXPECT_NEAR(glm::length(pose->eye), 3.0 * 2.0, 1e-9);
  }
  EXPECT_NEAR(client->nextDueMs(), 110.0 + 1100.0, 1e-9);
}

TEST_F(LightClientTest, LatencyStartsAtThePlannedTimeOfThePose) {
  auto client = makeClient();
  bringUp(*client);
  client->tick(110.0);
  client->tick(450.0);  // poses planned for 210, 310 and 410
  give(*client, protocol::Packet{0, 2, splits_}, 460.0);
  EXPECT_EQ(counters_.poseToPacket.percentile(1.0), 250.0);
  give(*client, protocol::Packet{0, 2, splits_}, 500.0);  // the first answer counts, no other
  EXPECT_EQ(counters_.poseToPacket.count(), 1u);
  give(*client, protocol::Settled{0, 2, protocol::Goal::kSettled}, 510.0);
  EXPECT_EQ(counters_.settled.percentile(1.0), 300.0);
}

TEST_F(LightClientTest, OtherBytesThanAnotherClientReceivedAreAnError) {
  auto first = makeClient();
  bringUp(*first, 1);
  auto second = makeClient(1);
  bringUp(*second, 77);
  EXPECT_EQ(counters_.decodeErrors, 1u);
  EXPECT_TRUE(second->finished());
  EXPECT_FALSE(first->finished());
}

TEST_F(LightClientTest, WhatIsNoMessageIsADecodeError) {
  auto client = makeClient();
  bringUp(*client);
  client->received(std::array<std::uint8_t, 5>{1, 2, 3, 4, 5}, 120.0);
  EXPECT_EQ(counters_.decodeErrors, 1u);
  EXPECT_EQ(counters_.dropped, 1u);
}

TEST_F(LightClientTest, AnAnswerToAPoseThatWasNeverSentIsADecodeError) {
  auto client = makeClient();
  bringUp(*client);
  client->tick(110.0);
  give(*client, protocol::Packet{0, 99, splits_}, 120.0);
  EXPECT_EQ(counters_.decodeErrors, 1u);
}

TEST_F(LightClientTest, LosingTheLineCountsAsDroppedOrFailedOnce) {
  auto late = makeClient();
  bringUp(*late);
  late->closed("gone", 500.0);
  late->closed("gone", 500.0);
  EXPECT_EQ(counters_.dropped, 1u);
  auto early = makeClient();
  early->tick(100.0);
  early->closed("refused", 101.0);
  EXPECT_EQ(counters_.failed, 1u);
  auto refused = makeClient();
  refused->tick(100.0);
  refused->opened(100.0);
  give(*refused, protocol::Failure{protocol::WireError::kNotFound, -1, "no such model", 0}, 105.0);
  EXPECT_EQ(counters_.failed, 2u);
}

TEST_F(LightClientTest, WhoReturnsComesBackWhenTheLineIsLost) {
  phase_.returns = true;
  auto client = makeClient();
  bringUp(*client);
  client->closed("gone", 500.0);
  EXPECT_EQ(counters_.dropped, 0u);
  EXPECT_EQ(counters_.reconnects, 1u);
  const double dueMs = client->nextDueMs();
  EXPECT_GT(dueMs, 500.0);
  client->tick(dueMs);
  EXPECT_EQ(client->takeWish(), LightClient::Wish::kConnect);
}

TEST_F(LightClientTest, WhoIsNotMeasuredCountsNoLatencyOfPoses) {
  for (const bool measured : {false, true}) {
    phase_.measured = measured;
    auto client = makeClient();
    bringUp(*client);
    client->tick(110.0);
    give(*client, protocol::Packet{0, 1, splits_, {}}, 150.0);
    give(*client, protocol::Settled{0, 1, protocol::Goal::kSettled}, 160.0);
    EXPECT_EQ(counters_.poseToPacket.count(), measured ? 1u : 0u);
    EXPECT_EQ(counters_.settled.count(), measured ? 1u : 0u);
  }
}

TEST_F(LightClientTest, WaitsForAModelThatIsNotReadyAndCountsTheWait) {
  auto client = makeClient();
  client->tick(100.0);
  EXPECT_EQ(client->takeWish(), LightClient::Wish::kConnect);
  client->opened(100.0);
  give(*client, protocol::Welcome{limits::kProtocolVersion, "server"}, 100.0);
  give(*client, protocol::Failure{protocol::WireError::kNotReady, 0, "being prepared", 250}, 110.0);
  EXPECT_EQ(client->takeWish(), LightClient::Wish::kAbort);
  EXPECT_EQ(client->nextDueMs(), 360.0);
  client->tick(360.0);
  EXPECT_EQ(client->takeWish(), LightClient::Wish::kConnect);
  client->opened(360.0);
  give(*client, protocol::Welcome{limits::kProtocolVersion, "server"}, 360.0);
  give(*client, info(), 360.0);
  give(*client, base(1), 400.0);
  EXPECT_EQ(counters_.base.percentile(1.0), 300.0);
  EXPECT_EQ(counters_.failed, 0u);
}

TEST_F(LightClientTest, AChurningClientLeavesAndComesBack) {
  phase_.behaviour = Behaviour::kChurn;
  auto client = makeClient();
  bringUp(*client);
  client->tick(3200.0);
  EXPECT_EQ(client->takeWish(), LightClient::Wish::kAbort);
  client->tick(3200.0);
  EXPECT_EQ(client->takeWish(), LightClient::Wish::kConnect);
  EXPECT_EQ(counters_.reconnects, 1u);
  EXPECT_EQ(counters_.dropped, 0u);
}

TEST_F(LightClientTest, AMalformedClientExpectsToBeThrownOut) {
  phase_.behaviour = Behaviour::kMalformed;
  auto client = makeClient();
  bringUp(*client);
  client->tick(200.0);
  EXPECT_EQ(client->takeOutgoing().size(), 1u);
  client->closed("thrown out", 210.0);
  EXPECT_EQ(counters_.dropped, 0u);
  EXPECT_FALSE(client->finished());
}

TEST_F(LightClientTest, ASlowLinkDelaysReading) {
  phase_.linkKbps = 8.0;  // a byte a millisecond
  auto client = makeClient();
  bringUp(*client);
  EXPECT_GT(client->readableAtMs(), 110.0 + 100.0);
}

TEST_F(LightClientTest, EndsPolitelyWithItsPhase) {
  auto client = makeClient();
  bringUp(*client);
  client->tick(10'000.0);
  EXPECT_EQ(client->takeWish(), LightClient::Wish::kDisconnect);
  EXPECT_TRUE(client->finished());
  EXPECT_TRUE(std::isinf(client->nextDueMs()));
  EXPECT_EQ(counters_.failed + counters_.dropped, 0u);
}

}  // namespace
}  // namespace limn::load
