// SPDX-License-Identifier: Apache-2.0
#include "client/core/client_session.h"

#include "client/net/replay_connection.h"
#include "tests/unit/client/core/small_asset.h"

#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <atomic>

namespace limn {
namespace {

constexpr std::uint64_t kLongMs = 20'000;

const SmallAsset& knot() {
  static const SmallAsset asset = makeSmallAsset(primitives::torusKnot(2, 3, 80, 8));
  return asset;
}

/// What a server says at the start of a connection.
std::vector<ReplayStep> opening(const SmallAsset& asset) {
  return {
      {"Hello", protocol::encodeMessage(protocol::Welcome{1, "recording"}), false},
      {"Open", asset.info, false}};
}

void append(std::vector<ReplayStep>& steps, const std::vector<std::uint8_t>& message) {
  steps.push_back({"", message, false});
}

ClientSession::Options until(MeshState state) {
  ClientSession::Options options;
  options.session.model = "knot";
  options.session.stop.state = state;
  return options;
}

TEST(ClientSession, DecodesARecordingToTheEnd) {
  ClientSession session(
      [] {
        auto steps = opening(knot());
        append(steps, knot().base);
        for (const auto& block : knot().blocks)
          append(steps, block);
        for (const auto& packet : knot().packets)
          append(steps, packet);
        return makeReplayConnection(steps);
      },
      until(MeshState::kComplete));
  const auto model = session.waitForModel(kLongMs);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->vertices, knot().built.forest.vertexCount());
  const auto outcome = session.waitUntilDone(kLongMs);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->state, MeshState::kComplete);
  EXPECT_TRUE(isWhole(knot(), outcome->snapshot->mesh));
  EXPECT_EQ(session.latest(), outcome->snapshot);
  EXPECT_FALSE(session.isRunning());
}

TEST(ClientSession, GoesOnFromWhatItHoldsAfterALoss) {
  std::atomic<int> connections{0};
  ClientSession session(
      [&connections] {
        auto steps = opening(knot());
        if (connections++ == 0) {
          append(steps, knot().base);
          for (const auto& block : knot().blocks)
            append(steps, block);
          append(steps, knot().packets.front());
          steps.back().lost = true;
        } else {
          // Only what was missing; a client that had dropped its mesh could not take it.
          steps.push_back({"HaveSet", {}, false});
          for (std::size_t i = 1; i < knot().packets.size(); ++i)
            append(steps, knot().packets[i]);
        }
        return makeReplayConnection(steps);
      },
      until(MeshState::kComplete));
  const auto outcome = session.waitUntilDone(kLongMs);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(connections, knot().packets.size() == 1 ? 1 : 2);
  EXPECT_TRUE(isWhole(knot(), outcome->snapshot->mesh));
}

TEST(ClientSession, PublishesOnTheWay) {
  ClientSession session(
      [] {
        auto steps = opening(knot());
        append(steps, knot().base);
        return makeReplayConnection(steps);
      },
      until(MeshState::kComplete));
  const auto outcome = session.waitForState(MeshState::kBase, kLongMs);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->state, MeshState::kBase);
  ASSERT_NE(session.latest(), nullptr);
  EXPECT_EQ(session.latest()->mesh.splitsHeld(), 0U);
  EXPECT_TRUE(session.isRunning());
}

TEST(ClientSession, WaitingForAStateHonoursANewView) {
  ClientSession session(
      [] {
        auto steps = opening(knot());
        append(steps, knot().base);
        steps.push_back(
            {"Pose",
             protocol::encodeMessage(protocol::Settled{0, 1, protocol::Goal::kSettled}),
             false});
        return makeReplayConnection(steps);
      },
      [] {
        auto options = until(MeshState::kComplete);
        options.session.stop.kind = StopCondition::Kind::kNever;
        return options;
      }());
  ASSERT_TRUE(session.waitForModel(kLongMs));
  session.setView(ClientView{});
  const auto outcome = session.waitForState(MeshState::kSettled, kLongMs);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->state, MeshState::kSettled);
  // What was settled for the first view says nothing about another one.
  ClientView other;
  other.camera.eye = {9.0, 0.0, 0.0};
  session.setView(other);
  const auto later = session.waitForState(MeshState::kSettled, 50);
  ASSERT_FALSE(later);
  EXPECT_EQ(later.error().code, ErrorCode::kUnavailable);
}

TEST(ClientSession, TellsWhyItFailed) {
  ClientSession session(
      [] {
        return makeReplayConnection(
            {{"Hello",
              protocol::encodeMessage(
                  protocol::Failure{protocol::WireError::kNotFound, -1, "no such model", 0}),
              false}});
      },
      until(MeshState::kComplete));
  const auto outcome = session.waitUntilDone(kLongMs);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(outcome.error().message, "no such model");
  EXPECT_FALSE(session.waitForModel(kLongMs));
}

TEST(ClientSession, ADestroyedSessionLeavesNothingRunning) {
  for (int i = 0; i < 20; ++i) {
    ClientSession session(
        [] { return makeReplayConnection(opening(knot())); },
        until(MeshState::kBase));
    EXPECT_FALSE(session.waitUntilDone(i % 3));
  }
}

}  // namespace
}  // namespace limn
