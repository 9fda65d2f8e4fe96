// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/load/report.h"
#include "client/load/script.h"

#include "protocol/messages.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"
#include "shared/core/rng.h"
#include "shared/core/sha256.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace limn::load {

/// Takes every server message of one model in order and decodes it into a mesh, fully.
class PayloadDecoder {
 public:
  virtual ~PayloadDecoder() = default;
  /// Returns the splits that the message applied. Errors: whatever is wrong with the bytes.
  [[nodiscard]] virtual Result<std::uint64_t> decode(const protocol::Message& message) = 0;
  /// The messages that tell a server what is held, encoded; the model must have begun.
  [[nodiscard]] virtual std::vector<std::vector<std::uint8_t>> haveSet(
      std::uint8_t channel) const = 0;
};

/// Digests of the messages that a server sends to everyone alike (Base, level blocks, seeds, and
/// the coder of ModelInfo). The first client to receive one sets it; all others must get the
/// same bytes. One thread.
class SharedDigests {
 public:
  /// False when `bytes` differ from what another client received under the same key.
  [[nodiscard]] bool matches(const Sha256Digest& asset, int section, protocol::Bytes bytes);

 private:
  std::map<std::pair<Sha256Digest, int>, Sha256Digest> digests_;
};

/// One light client: speaks the protocol as its phase's behaviour says, checks what it receives,
/// counts. Knows neither sockets nor clocks: bytes and times (milliseconds of any steady clock) are
/// arguments, so that a test can be its server. One thread.
///
/// Latencies start at the *planned* time of a connection or pose (open loop), so that a stalled
/// server or an overloaded generator cannot hide waiting time.
class LightClient {
 public:
  struct Plan {
    const Phase* phase = nullptr;  // outlives the client
    std::uint32_t index = 0;       // among the clients of its phase: where on the orbit it starts
    double startMs = 0.0;
    double endMs = 0.0;
    /// Makes a decoder for each connection; empty: check what comes, but do not decode it.
    std::function<std::unique_ptr<PayloadDecoder>()> makeDecoder;
  };

  LightClient(Plan plan, SharedDigests& digests, Counters& counters);

  /// What to do about the connection, asked after every call below.
  enum class Wish : std::uint8_t {
    kNothing,
    kConnect,     // the time has come (again)
    kDisconnect,  // close politely
    kAbort,       // cut the line without a word
  };

  [[nodiscard]] Wish takeWish() { return std::exchange(wish_, Wish::kNothing); }

  /// Messages to send, in order.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> takeOutgoing() {
    return std::exchange(outgoing_, {});
  }

  void opened(double nowMs);
  void received(std::span<const std::uint8_t> bytes, double nowMs);
  /// The line is gone, or could not be had; `reason` is for the report.
  void closed(const std::string& reason, double nowMs);
  /// Does what is due. Call at or after nextDueMs().
  void tick(double nowMs);
  [[nodiscard]] double nextDueMs() const;

  /// A slow link: do not read before this time.
  [[nodiscard]] double readableAtMs() const { return readableAtMs_; }

  [[nodiscard]] bool finished() const { return state_ == State::kFinished; }

 private:
  enum class State : std::uint8_t {
    kWaiting,     // for startMs, or for the next attempt
    kConnecting,  // until Welcome
    kOpening,     // until ModelInfo
    kStreaming,
    kFinished,
  };

  struct SentPose {
    std::uint32_t id = 0;
    double plannedMs = 0.0;
    std::uint64_t payloadBefore = 0;  // received when it was sent
    bool answered = false;
    std::size_t settled = 0;  // models that are
  };

  /// One model of the connection.
  struct Channel {
    std::string model;
    std::optional<Sha256Digest> asset;
    BoundingSphere sphere;
    bool baseHere = false;
    bool resuming = false;
    std::unique_ptr<PayloadDecoder> decoder;
  };

  void send(const protocol::Body& body) { outgoing_.push_back(protocol::encodeMessage(body)); }

  void sendPose(double plannedMs);
  void sendRubbish();
  void handle(const protocol::Message& message, double nowMs);
  void handleInfo(const protocol::ModelInfo& info, double nowMs);
  void checkShared(const Channel& channel, int section, protocol::Bytes bytes);
  void openChannels();
  void resume(const Channel& channel, std::uint8_t id);
  void answer(std::uint32_t pose, double nowMs, std::optional<protocol::Goal> settled);
  void decodeError(const std::string& what);
  /// Ends the client for good. `failure` is empty when all went well.
  void finish(const std::string& failure);
  void restartAfter(double nowMs, double pauseMs);
  [[nodiscard]] Camera cameraAt(const Channel& channel, double nowMs) const;
  [[nodiscard]] bool mayBeThrownOut() const;

  [[nodiscard]] bool mayReturn() const { return plan_.phase->returns && reachedBase_; }

  Plan plan_;
  SharedDigests& digests_;
  Counters& counters_;
  Rng rng_;
  State state_ = State::kWaiting;
  Wish wish_ = Wish::kNothing;
  std::vector<std::vector<std::uint8_t>> outgoing_;

  double attemptMs_ = 0.0;  // planned time of the present or next connection
  double plannedMs_ = 0.0;  // where its latencies begin: the first attempt's time
  double leaveMs_ = 0.0;    // when a churning client leaves
  double nextPoseMs_ = 0.0;
  double firstPoseMs_ = 0.0;
  double readableAtMs_ = 0.0;
  bool reachedBase_ = false;  // ever
  std::uint32_t nextPoseId_ = 1;
  std::uint64_t acknowledged_ = 0;
  std::deque<SentPose> poses_;  // the latest ones, for the latencies
  std::vector<Channel> channels_;
};

}  // namespace limn::load
