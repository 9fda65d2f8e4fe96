// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/stream_decoder.h"
#include "server/session/session.h"
#include "tests/unit/server/session/test_model.h"

#include "protocol/limits.h"

#include "shared/codec/id_set.h"
#include "shared/mesh/primitives.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace limn {

inline const std::shared_ptr<const Model>& bumpy() {
  static const auto model = modelOf(primitives::bumpySphere(4, 3), 1);
  return model;
}

inline const std::shared_ptr<const Model>& torus() {
  static const auto model = modelOf(primitives::torus(40, 20), 2);
  return model;
}

/// A session and the client at its other end: a real decoder for each channel, acknowledging when
/// it likes to.
class Link final : public Peer {
 public:
  explicit Link(SessionOptions options = {})
      : cells_(tasks_, {}),
        shared_{models_, cells_, options},
        session_(shared_, *this, 0) {
    models_.add("bumpy", bumpy());
    models_.add("torus", torus());
  }

  void wantWrite() override { ++wants_; }

  void send(const protocol::Body& body) { session_.receive(protocol::encodeMessage(body), now_); }

  void hello() { send(protocol::Hello{1, "test"}); }

  void open(const std::string& model, std::uint8_t channel = 0, bool resume = false) {
    send(protocol::Open{channel, model, resume});
  }

  protocol::Pose look(const glm::dvec3& direction, protocol::Goal goal, std::uint8_t channel = 0) {
    protocol::Pose pose = poseAt(bumpy()->info(), direction);
    pose.channel = channel;
    pose.id = ++poseId_;
    pose.goal = goal;
    send(pose);
    return pose;
  }

  void acknowledge() { send(protocol::Acknowledge{payload_}); }

  /// Takes what the window lets through, decoding it. Returns how many messages.
  int take() {
    int count = 0;
    while (auto out = session_.nextMessage(now_)) {
      ++count;
      const auto message = protocol::decodeMessage(out->bytes(), protocol::Sender::kServer);
      EXPECT_TRUE(message) << message.error().message;
      EXPECT_LE(out->bytes().size(), limits::kMaxServerMessageBytes);
      EXPECT_EQ(out->payload, protocol::isPayload(message->body));
      if (out->payload) payload_ += out->bytes().size();
      if (const auto* packet = message->as<protocol::Packet>())
        packetBytes_ += packet->splits.size();
      note(*message);
    }
    return count;
  }

  /// Goes on until nothing moves: background work, time, acknowledgements.
  void settle(std::int64_t forMs = 0) {
    const std::int64_t until = now_ + forMs;
    for (int quiet = 0; quiet < 2;) {
      const std::size_t worked = tasks_.runAll();
      session_.update(now_);
      const int taken = take();
      acknowledge();
      quiet = worked + static_cast<std::size_t>(taken) == 0 ? quiet + 1 : 0;
      if (quiet == 2 && now_ < until) {
        now_ += 50;
        quiet = 0;
      }
    }
  }

  StreamDecoder& decoder(std::uint8_t channel = 0) { return decoders_[channel]; }

  void note(const protocol::Message& message) {
    const auto channel = protocol::channelOf(message.body);
    std::visit([&](const auto& body) { take(channel, body); }, message.body);
  }

  void take(std::optional<std::uint8_t> channel, const protocol::ModelInfo& info) {
    names_.push_back(std::string(info.name));
    expectOk(decoders_[*channel].beginModel(info));
  }

  template <class Payload>

  requires requires(StreamDecoder& d, const Payload& p) { d.take(p); }

  void take(std::optional<std::uint8_t> channel, const Payload& payload) {
    expectOk(decoders_[*channel].take(payload));
  }

  void take(std::optional<std::uint8_t>, const protocol::Settled& settled) {
    settled_.push_back({settled.pose, settled.state});
    heldWhenSettled_.push_back(decoders_[settled.channel].mesh().splitsHeld());
  }

  void take(std::optional<std::uint8_t>, const protocol::Failure& failure) {
    failures_.push_back(failure.code);
    failureChannels_.push_back(failure.channel);
    failureTexts_.emplace_back(failure.message);
  }

  void take(std::optional<std::uint8_t>, const protocol::Dropped& dropped) {
    const auto kept = decodeIdSet(dropped.kept, 1U << 27);
    ASSERT_TRUE(kept) << kept.error().message;
    kept_ = *kept;
    ++drops_;
  }

  void take(std::optional<std::uint8_t>, const protocol::Full& full) {
    full_.push_back({full.pose, full.missing});
  }

  void take(std::optional<std::uint8_t>, const protocol::Contour& contour) {
    contours_.push_back({contour.id, {contour.lines.begin(), contour.lines.end()}});
  }

  void take(std::optional<std::uint8_t>, const protocol::Catalogue& catalogue) {
    catalogueSizes_.push_back(catalogue.models.size());
  }

  template <class Other>

  requires(!requires(StreamDecoder & d, const Other& p) {
    d.take(p);
  }) void take(std::optional<std::uint8_t>, const Other&) {}

  static void expectOk(const Result<void>& result) {
    EXPECT_TRUE(result) << result.error().message;
  }

  ManualTasks tasks_;
  FixedModels models_;
  ViewCells cells_;
  SessionShared shared_;
  Session session_;
  std::map<std::uint8_t, StreamDecoder> decoders_;
  std::int64_t now_ = 0;
  int wants_ = 0;
  std::uint32_t poseId_ = 0;
  std::uint64_t payload_ = 0;
  std::uint64_t packetBytes_ = 0;
  std::vector<std::string> names_;
  std::vector<std::pair<std::uint32_t, protocol::Goal>> settled_;
  std::vector<std::uint32_t> heldWhenSettled_;
  std::vector<protocol::WireError> failures_;
  std::vector<int> failureChannels_;
  std::vector<std::string> failureTexts_;
  std::vector<std::size_t> catalogueSizes_;
  std::optional<std::vector<VertexId>> kept_;  // of the last Dropped
  int drops_ = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> full_;
  std::vector<std::pair<std::uint32_t, std::vector<std::uint8_t>>> contours_;
};

}  // namespace limn
