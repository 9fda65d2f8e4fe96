// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/connection.h"
#include "client/core/session_machine.h"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace limn {

/// A session at work, on one model or several over one connection (numbered as in
/// SessionMachine): its decode thread owns a SessionMachine and through it the mesh, the
/// connection has its own network thread, and the caller's thread (usually the renderer's) reads
/// immutable snapshots and never waits for either.
///
///   network thread ── messages ──→ decode thread ── shared_ptr<const MeshSnapshot> ──→ caller
///
/// Threads: every public method may be called from any thread.
class ClientSession {
 public:
  struct Options {
    SessionMachine::Options session;
    /// How often the growing mesh is published while nothing special happens. A snapshot is a copy,
    /// so this bounds the time spent on copying. The stop condition always publishes.
    std::uint64_t publishEveryMs = 100;
  };

  /// Begins at once, on its own threads.
  ClientSession(ConnectionFactory connect, Options options);
  /// Stops and joins.
  ~ClientSession();
  ClientSession(const ClientSession&) = delete;
  ClientSession& operator=(const ClientSession&) = delete;

  /// Blocks until the model's description is there, at most timeoutMs.
  /// Errors: why the session failed; kUnavailable: not yet (and isRunning() is true).
  [[nodiscard]] Result<ModelDescription> waitForModel(
      std::uint64_t timeoutMs,
      std::size_t model = 0);

  /// Blocks until the stop condition holds, at most timeoutMs. Errors: as above.
  [[nodiscard]] Result<SessionOutcome> waitUntilDone(std::uint64_t timeoutMs);

  /// Blocks until the newest view has that state or a later one, at most timeoutMs; for sessions
  /// that go on. Errors: as above; kLimitExceeded when it does not fit into the memory given.
  [[nodiscard]] Result<SessionOutcome> waitForState(MeshState state, std::uint64_t timeoutMs);

  /// Neither failed nor done.
  [[nodiscard]] bool isRunning() const;

  void setView(const ClientView& view, std::size_t model = 0);

  /// The latest published mesh, or null before the base mesh. Never blocks for long: the lock is
  /// held for a pointer's copy only.
  [[nodiscard]] std::shared_ptr<const MeshSnapshot> latest(std::size_t model = 0) const;

  struct Progress {
    MeshState state = MeshState::kNothing;
    std::uint32_t splitsHeld = 0;  // of all models
    std::uint32_t splitsTotal = 0;
    ByteCounters bytes;
    std::string notice;  // empty, or one line about what it waits for
  };

  [[nodiscard]] Progress progress() const;

 private:
  struct Event {
    enum class Kind : std::uint8_t { kOpen, kMessage, kClosed } kind;
    std::vector<std::uint8_t> message;
    std::size_t wireBytes = 0;
    Error reason;
  };
  class Inbox;

  void decodeLoop();
  void serveConnection(std::uint64_t nowMs);
  void handle(Event event, std::uint64_t nowMs);
  void publish(std::uint64_t nowMs);
  [[nodiscard]] bool hasNewView() const;
  template <class Condition>
  bool waitFor(std::unique_lock<std::mutex>& lock, std::uint64_t timeoutMs, Condition condition);
  [[nodiscard]] SessionOutcome outcomeNow() const;
  [[nodiscard]] std::uint64_t nowMs() const;

  // Constant after construction.
  const ConnectionFactory connect_;
  const Options options_;

  // Owned by the decode thread.
  SessionMachine machine_;
  std::shared_ptr<Inbox> listener_;  // of the present connection
  std::unique_ptr<Connection> connection_;
  std::uint32_t connectionNumber_ = 0;
  std::uint64_t publishedAtMs_ = 0;

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::condition_variable wakeDecoder_;
  std::condition_variable wakeCaller_;
  std::deque<Event> events_;
  std::size_t eventBytes_ = 0;
  std::vector<std::optional<ClientView>> newViews_;  // by model
  bool stopping_ = false;
  bool checkWanted_ = false;
  std::vector<std::optional<ModelDescription>> models_;
  std::vector<std::shared_ptr<const MeshSnapshot>> snapshots_;
  std::optional<SessionOutcome> outcome_;       // of the stop condition
  std::optional<MeshState> wantedState_;        // by waitForState()
  std::optional<SessionOutcome> stateReached_;  // answers it
  std::optional<Error> stateBlocked_;           // or this does
  std::optional<Error> failure_;
  Progress progress_;

  std::thread decoder_;  // last: it uses everything above
};

}  // namespace limn
