// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/backoff.h"
#include "client/core/byte_counters.h"
#include "client/core/model_stream.h"
#include "client/core/pose_reporter.h"
#include "client/core/session_state.h"
#include "client/core/stream_decoder.h"

#include "shared/core/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace limn {

/// What a client does about one model of one server, or several over one connection, from the first
/// Hello to the state that was asked for, over lost connections too. It has no thread, socket or
/// clock: events and the time go in, messages and a wish for a connection come out, so that every
/// path can be tested.
///
/// Phases (SPEC.md "States" has them with the server's side):
///
///   kConnecting → kGreeting (Hello sent) → kOpening (Open sent) → kStreaming → kDone
///        ↑________________ kWaiting (backoff) ←__ any loss __________|       kFailed
///
/// A session that has begun a model opens it again with `resume` and its have-set, and goes on from
/// what it holds. A model is named by its place among those asked for, 0 the first; that is also
/// its channel. What goes on about each is ModelStream's. Threads: one at a time.
class SessionMachine {
 public:
  struct Options : StreamOptions {
    std::string model;
    std::vector<std::string> moreModels;  // opened beside it, on channels of their own
    std::string clientName = "limn-client";
    StopCondition stop;
    /// A state counts only once the silhouette seeds have come too, if there are any.
    bool needsSeeds = false;
    /// What the meshes and their snapshots may take, shared evenly by the models; 0: no limit. The
    /// splits least needed are dropped when it is used up.
    std::uint64_t memoryBytes = 0;
    std::uint64_t giveUpAfterMs = 30'000;  // of trying to get back to a lost server
    std::uint64_t silenceMs = 30'000;      // of a server that owes something: taken for a loss
    std::uint64_t seed = 1;                // of the backoff's jitter
  };

  enum class Phase : std::uint8_t {
    kWaiting,     // for the next try; or, at first, for start()
    kConnecting,  // the owner is making a connection
    kGreeting,
    kOpening,
    kStreaming,
    kDone,    // the stop condition holds; what was captured then does not change any more
    kFailed,  // failure() says why
  };

  explicit SessionMachine(Options options);
  SessionMachine(const SessionMachine&) = delete;
  SessionMachine& operator=(const SessionMachine&) = delete;

  // ---- Events

  void start(std::uint64_t nowMs);
  void onOpen(std::uint64_t nowMs);
  /// wireBytes: message and frame header.
  void onMessage(protocol::Bytes message, std::size_t wireBytes, std::uint64_t nowMs);
  void onClosed(const Error& reason, std::uint64_t nowMs);
  /// The inbox is empty: what was decoded is acknowledged now.
  void onIdle(std::uint64_t nowMs);
  /// Call when wakeAtMs() has come.
  void onTimer(std::uint64_t nowMs);
  void setView(const ClientView& view, std::uint64_t nowMs, std::size_t model = 0);

  // ---- What the owner should do

  /// Messages to send on the present connection, in order; empties the outbox.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> takeOutbox();
  /// Whether a connection should exist. When this goes from false to true, or connectionNumber()
  /// changes, the owner closes the old one and starts a fresh one.
  [[nodiscard]] bool wantsConnection() const;

  [[nodiscard]] std::uint32_t connectionNumber() const { return connections_; }

  [[nodiscard]] std::optional<std::uint64_t> wakeAtMs() const;

  // ---- Where it stands

  [[nodiscard]] Phase phase() const { return phase_; }

  [[nodiscard]] std::size_t modelCount() const { return streams_.size(); }

  [[nodiscard]] const StreamDecoder& decoder(std::size_t model = 0) const {
    return streams_[model].decoder();
  }

  /// Of the model that is least far.
  [[nodiscard]] MeshState state() const;
  [[nodiscard]] MeshState state(std::size_t model) const;

  /// How many splits of a model there is room for; nullopt: no limit, or not known yet.
  [[nodiscard]] std::optional<std::uint32_t> room(std::size_t model = 0) const;

  /// Whether every model's newest view has that state or a later one, with the seeds if they are
  /// needed.
  [[nodiscard]] bool hasReached(MeshState state) const;

  [[nodiscard]] const ByteCounters& bytes() const { return bytes_; }

  [[nodiscard]] const StateTimes& times() const { return times_; }

  /// Connections that came about after the first one.
  [[nodiscard]] std::uint32_t reconnects() const { return opened_ == 0 ? 0 : opened_ - 1; }

  [[nodiscard]] const ContourTimes& contours() const { return contourTimes_; }

  /// Set in kFailed.
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }

  /// Why a present view will get no further although the server could send more: no room. Until the
  /// next view.
  [[nodiscard]] const std::optional<Error>& blocked() const { return blocked_; }

  /// What the server last said about why it cannot serve the model yet; for a progress line.
  [[nodiscard]] const std::string& notice() const { return notice_; }

 private:
  void handle(ModelStream& stream, const protocol::ModelInfo& message, std::uint64_t nowMs);
  void handle(ModelStream& stream, const protocol::Settled& message, std::uint64_t nowMs);
  void handle(ModelStream& stream, const protocol::Dropped& message, std::uint64_t nowMs);
  void handle(ModelStream& stream, const protocol::Full& message, std::uint64_t nowMs);
  void handle(const protocol::Welcome& message, std::uint64_t nowMs);
  void handle(const protocol::Failure& message, std::uint64_t nowMs);
  template <class Payload>
  void handlePayload(
      ModelStream& stream,
      const Payload& message,
      std::size_t messageBytes,
      std::uint64_t nowMs);

  [[nodiscard]] bool hasAnyBase() const;
  void acknowledge();
  /// The stream is damaged.
  void loseDamaged(const Error& reason, std::uint64_t nowMs);
  void lose(const Error& reason, std::uint64_t nowMs, std::uint64_t retryAfterMs);
  void failWith(Error error);
  void noteProgress();
  void noteStates(std::uint64_t nowMs);
  void checkStop();
  [[nodiscard]] bool owesAnswer() const;

  Options options_;
  Phase phase_ = Phase::kWaiting;
  Outbox outbox_;
  std::vector<ModelStream> streams_;
  ByteCounters bytes_;
  StateTimes times_;
  ContourTimes contourTimes_;
  std::optional<Error> failure_;
  std::optional<Error> blocked_;
  std::string notice_;
  Backoff backoff_;

  std::uint64_t startMs_ = 0;
  std::uint32_t connections_ = 0;  // asked for
  std::uint32_t opened_ = 0;
  bool everWelcomed_ = false;
  std::uint64_t taken_ = 0;  // payload bytes of this connection
  std::uint64_t acknowledged_ = 0;
  std::uint32_t damages_ = 0;  // of the stream, in a row
  std::uint64_t retryAtMs_ = 0;
  std::uint64_t lastHeardMs_ = 0;
};

}  // namespace limn
