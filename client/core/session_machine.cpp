// SPDX-License-Identifier: Apache-2.0
#include "client/core/session_machine.h"

#include "client/core/have_set.h"

#include "protocol/handshake.h"
#include "protocol/limits.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

/// Enough to keep the server's window open without an upstream message for every small packet.
constexpr std::uint64_t kAcknowledgeEveryBytes = 16 * 1024;
constexpr std::uint64_t kFirstBackoffMs = 100;
constexpr std::uint64_t kLargestBackoffMs = 5'000;
constexpr std::uint64_t kReopenMs = 1'000;
/// A stream that arrives damaged this often in a row will not get better.
constexpr std::uint32_t kMaxDamages = 3;

MeshState toState(protocol::Goal goal) {
  switch (goal) {
    case protocol::Goal::kSettled:
      return MeshState::kSettled;
    case protocol::Goal::kExact:
      return MeshState::kExact;
    case protocol::Goal::kComplete:
      return MeshState::kComplete;
  }
  return MeshState::kSettled;
}

}  // namespace

SessionMachine::SessionMachine(Options options)
    : options_(std::move(options)),
      jitter_(options_.seed) {}

// ---- Events

void SessionMachine::start(std::uint64_t nowMs) {
  startMs_ = nowMs;
  lastHeardMs_ = nowMs;
  phase_ = Phase::kConnecting;
  ++connections_;
}

void SessionMachine::onOpen(std::uint64_t nowMs) {
  if (phase_ != Phase::kConnecting) return;
  ++opened_;
  if (!times_.connectMs) times_.connectMs = static_cast<double>(nowMs - startMs_);
  lastHeardMs_ = nowMs;
  taken_ = 0;
  acknowledged_ = 0;
  settledAs_.reset();
  outbox_.push_back(encodeMessage(protocol::Hello{limits::kProtocolVersion, options_.clientName}));
  phase_ = Phase::kGreeting;
}

void SessionMachine::onMessage(protocol::Bytes bytes, std::size_t wireBytes, std::uint64_t nowMs) {
  if (phase_ != Phase::kGreeting && phase_ != Phase::kOpening && phase_ != Phase::kStreaming)
    return;
  lastHeardMs_ = nowMs;
  if (options_.stop.kind == StopCondition::Kind::kBytes &&
      bytes_.received + wireBytes > options_.stop.bytes) {
    if (!decoder_.hasBase()) {
      return failWith(
          {ErrorCode::kUnavailable,
           "bytes:" + std::to_string(options_.stop.bytes) +
               " is too few for the base mesh: ask for more"});
    }
    phase_ = Phase::kDone;
    return;
  }
  const auto message = protocol::decodeMessage(bytes, protocol::Sender::kServer);
  if (!message) {
    bytes_.countControl(wireBytes);
    ++damages_;
    return lose(message.error(), nowMs, 0);
  }
  bytes_.count(message->body, wireBytes);
  if (const auto channel = channelOf(message->body); channel && *channel != kChannel) {
    return lose({ErrorCode::kProtocol, "the server used a channel that is not open"}, nowMs, 0);
  }
  std::visit(
      [&](const auto& body) {
        if constexpr (requires { handle(body, nowMs); }) {
          handle(body, nowMs);
        } else if constexpr (requires { decoder_.take(body); }) {
          handlePayload(body, bytes.size(), nowMs);
        }
        // A Catalogue that nobody asked for does no harm.
      },
      message->body);
  if (phase_ == Phase::kStreaming) {
    noteStates(nowMs);
    checkStop(nowMs);
  }
}

void SessionMachine::onClosed(const Error& reason, std::uint64_t nowMs) {
  if (phase_ == Phase::kDone || phase_ == Phase::kFailed || phase_ == Phase::kWaiting) return;
  // A server that was never reached is most likely not there: say so at once.
  if (!everWelcomed_) return failWith(reason);
  lose(reason, nowMs, 0);
}

void SessionMachine::onIdle(std::uint64_t) {
  if (phase_ == Phase::kStreaming) acknowledge();
}

void SessionMachine::onTimer(std::uint64_t nowMs) {
  if (phase_ == Phase::kDone || phase_ == Phase::kFailed) return;
  if (options_.stop.kind == StopCondition::Kind::kSeconds &&
      static_cast<double>(nowMs - startMs_) >= 1000.0 * options_.stop.seconds) {
    if (!decoder_.hasBase()) {
      return failWith(
          {ErrorCode::kUnavailable,
           "the base mesh did not arrive in the seconds given: allow more"});
    }
    phase_ = Phase::kDone;
    return;
  }
  if (phase_ == Phase::kWaiting) {
    if (nowMs < retryAtMs_) return;
    phase_ = Phase::kConnecting;
    lastHeardMs_ = nowMs;
    ++connections_;
    return;
  }
  if (reopenAtMs_ && nowMs >= *reopenAtMs_) {
    reopenAtMs_.reset();
    sendOpen(nowMs);
  }
  if (phase_ == Phase::kStreaming) sendPoseIfDue(nowMs);
  if (owesAnswer() && nowMs >= lastHeardMs_ + options_.silenceMs) {
    const Error silent{
        ErrorCode::kNetwork,
        "the server has not answered for " + std::to_string(options_.silenceMs / 1000) + " s"};
    if (!everWelcomed_) return failWith(silent);
    lose(silent, nowMs, 0);
  }
}

void SessionMachine::setView(const View& view, std::uint64_t nowMs) {
  const std::uint32_t before = poses_.newestId();
  poses_.set(view);
  if (poses_.newestId() != before) settledAs_.reset();
  if (phase_ == Phase::kStreaming) sendPoseIfDue(nowMs);
}

// ---- Messages

void SessionMachine::handle(const protocol::Welcome& message, std::uint64_t nowMs) {
  if (phase_ != Phase::kGreeting) {
    return lose({ErrorCode::kProtocol, "the server greeted twice"}, nowMs, 0);
  }
  if (auto version = protocol::checkWelcome(message.version); !version) {
    return failWith(version.error());
  }
  everWelcomed_ = true;
  sendOpen(nowMs);
}

void SessionMachine::handle(const protocol::ModelInfo& message, std::uint64_t nowMs) {
  if (phase_ != Phase::kOpening) {
    return lose(
        {ErrorCode::kProtocol, "a model's description came that was not asked for"},
        nowMs,
        0);
  }
  const bool resuming = decoder_.hasModel();
  if (auto begun = decoder_.beginModel(message); !begun) {
    ++damages_;
    return lose(begun.error(), nowMs, 0);
  }
  // Also when the asset has changed meanwhile: then the have-set is empty, and the server, which
  // waits for it, begins from the base mesh.
  if (resuming) {
    for (auto& piece : encodeHaveSet(decoder_, kChannel))
      outbox_.push_back(std::move(piece));
  }
  phase_ = Phase::kStreaming;
  notice_.clear();
  noteProgress(nowMs);
  poses_.repeat();
  sendPoseIfDue(nowMs);
}

template <class Payload>
void SessionMachine::handlePayload(
    const Payload& message,
    std::size_t messageBytes,
    std::uint64_t nowMs) {
  if (phase_ != Phase::kStreaming) {
    return lose({ErrorCode::kProtocol, "mesh data came before a model was open"}, nowMs, 0);
  }
  if (auto taken = decoder_.take(message); !taken) {
    ++damages_;
    return lose(taken.error(), nowMs, 0);
  }
  damages_ = 0;
  noteProgress(nowMs);
  taken_ += messageBytes;
  if (taken_ - acknowledged_ >= kAcknowledgeEveryBytes) acknowledge();
}

void SessionMachine::handle(const protocol::Settled& message, std::uint64_t nowMs) {
  if (phase_ != Phase::kStreaming) {
    return lose({ErrorCode::kProtocol, "settled came before a model was open"}, nowMs, 0);
  }
  if (message.pose != poses_.newestId()) return;  // about a view that has passed
  const MeshState state = toState(message.state);
  if (state == MeshState::kComplete && !decoder_.complete()) {
    ++damages_;
    return lose(
        {ErrorCode::kProtocol, "the server says complete, but splits are missing"},
        nowMs,
        0);
  }
  if (!settledAs_ || *settledAs_ < state) settledAs_ = state;
  noteProgress(nowMs);
}

void SessionMachine::handle(const protocol::Failure& message, std::uint64_t nowMs) {
  const std::string what = message.message.empty() ? std::string(protocol::nameOf(message.code))
                                                   : std::string(message.message);
  switch (message.code) {
    case protocol::WireError::kNotReady:
      notice_ = what;
      // The channel is closed, the connection is not: the model is asked for again.
      phase_ = Phase::kOpening;
      reopenAtMs_ = nowMs + std::max<std::uint64_t>(message.retryAfterMs, kReopenMs);
      return;
    case protocol::WireError::kStale:
    case protocol::WireError::kHaveSet:
      if (decoder_.hasModel()) {
        decoder_.drop();
        settledAs_.reset();
        sendOpen(nowMs);
        return;
      }
      return failWith({ErrorCode::kProtocol, what});
    case protocol::WireError::kDraining:
      return lose({ErrorCode::kUnavailable, what}, nowMs, message.retryAfterMs);
    case protocol::WireError::kInternal:
      ++damages_;
      return lose({ErrorCode::kUnavailable, what}, nowMs, message.retryAfterMs);
    case protocol::WireError::kNotFound:
      return failWith({ErrorCode::kNotFound, what});
    case protocol::WireError::kLimit:
      return failWith({ErrorCode::kLimitExceeded, what});
    case protocol::WireError::kVersion:
    case protocol::WireError::kBadMessage:
    case protocol::WireError::kState:
      return failWith({ErrorCode::kProtocol, what});
  }
}

// ---- Actions

void SessionMachine::sendOpen(std::uint64_t) {
  outbox_.push_back(encodeMessage(protocol::Open{kChannel, options_.model, decoder_.hasModel()}));
  phase_ = Phase::kOpening;
}

void SessionMachine::sendPoseIfDue(std::uint64_t nowMs) {
  if (const auto pose = poses_.next(nowMs)) outbox_.push_back(encodeMessage(*pose));
}

void SessionMachine::acknowledge() {
  if (taken_ == acknowledged_) return;
  acknowledged_ = taken_;
  outbox_.push_back(encodeMessage(protocol::Acknowledge{taken_}));
}

void SessionMachine::lose(const Error& reason, std::uint64_t nowMs, std::uint64_t retryAfterMs) {
  outbox_.clear();
  reopenAtMs_.reset();
  settledAs_.reset();
  if (damages_ >= kMaxDamages) return failWith(reason.within("the stream keeps arriving damaged"));
  if (!lostAtMs_) lostAtMs_ = nowMs;
  // Doubled each time, with up to half of it as jitter, so that a restarted server is not stormed.
  const std::uint64_t backoff =
      std::min(kFirstBackoffMs << std::min(failedTries_, 10U), kLargestBackoffMs);
  const std::uint64_t wait =
      std::max(retryAfterMs, backoff) + jitter_.below(static_cast<std::uint32_t>(backoff / 2 + 1));
  ++failedTries_;
  if (nowMs + wait > *lostAtMs_ + options_.giveUpAfterMs) {
    return failWith(reason.within("the connection was lost and did not come back"));
  }
  notice_ = "connection lost (" + reason.message + "), trying again";
  retryAtMs_ = nowMs + wait;
  phase_ = Phase::kWaiting;
}

void SessionMachine::failWith(Error error) {
  failure_ = std::move(error);
  outbox_.clear();
  phase_ = Phase::kFailed;
}

void SessionMachine::noteProgress(std::uint64_t) {
  lostAtMs_.reset();
  failedTries_ = 0;
}

void SessionMachine::noteStates(std::uint64_t nowMs) {
  const auto sinceStart = static_cast<double>(nowMs - startMs_);
  const auto note = [&](std::optional<double>& time, MeshState least) {
    if (!time && state() >= least) time = sinceStart;
  };
  note(times_.baseMs, MeshState::kBase);
  note(times_.settledMs, MeshState::kSettled);
  note(times_.exactMs, MeshState::kExact);
  note(times_.completeMs, MeshState::kComplete);
}

void SessionMachine::checkStop(std::uint64_t) {
  const bool reached =
      (options_.stop.kind == StopCondition::Kind::kState && hasReached(options_.stop.state)) ||
      (options_.stop.kind == StopCondition::Kind::kBytes && state() == MeshState::kComplete);
  if (reached) phase_ = Phase::kDone;
}

bool SessionMachine::owesAnswer() const {
  switch (phase_) {
    case Phase::kConnecting:
    case Phase::kGreeting:
      return true;
    case Phase::kOpening:
      return !reopenAtMs_;
    case Phase::kStreaming:
      // The base mesh is owed from the start; more only for a view that has been told.
      return !decoder_.hasBase() || (poses_.newestId() != 0 && state() < MeshState::kSettled) ||
             (options_.stop.kind == StopCondition::Kind::kState && poses_.newestId() != 0 &&
              !hasReached(options_.stop.state));
    default:
      return false;
  }
}

// ---- Queries

std::vector<std::vector<std::uint8_t>> SessionMachine::takeOutbox() {
  std::vector<std::vector<std::uint8_t>> messages(
      std::make_move_iterator(outbox_.begin()),
      std::make_move_iterator(outbox_.end()));
  outbox_.clear();
  return messages;
}

bool SessionMachine::wantsConnection() const {
  return phase_ == Phase::kConnecting || phase_ == Phase::kGreeting || phase_ == Phase::kOpening ||
         phase_ == Phase::kStreaming;
}

std::optional<std::uint64_t> SessionMachine::wakeAtMs() const {
  if (phase_ == Phase::kDone || phase_ == Phase::kFailed) return std::nullopt;
  std::optional<std::uint64_t> wake;
  const auto consider = [&wake](std::uint64_t at) { wake = wake ? std::min(*wake, at) : at; };
  if (phase_ == Phase::kWaiting) consider(retryAtMs_);
  if (reopenAtMs_) consider(*reopenAtMs_);
  if (phase_ == Phase::kStreaming && poses_.dueAtMs()) consider(*poses_.dueAtMs());
  if (owesAnswer()) consider(lastHeardMs_ + options_.silenceMs);
  if (options_.stop.kind == StopCondition::Kind::kSeconds) {
    consider(startMs_ + static_cast<std::uint64_t>(1000.0 * options_.stop.seconds + 0.999));
  }
  return wake;
}

bool SessionMachine::hasReached(MeshState wanted) const {
  return state() >= wanted && (!options_.needsSeeds || decoder_.seedsAreThere());
}

MeshState SessionMachine::state() const {
  if (!decoder_.hasBase()) return MeshState::kNothing;
  if (decoder_.complete()) return MeshState::kComplete;
  if (settledAs_) return *settledAs_;
  return decoder_.mesh().splitsHeld() == 0 ? MeshState::kBase : MeshState::kPartial;
}

}  // namespace limn
