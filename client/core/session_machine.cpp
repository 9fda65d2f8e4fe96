// SPDX-License-Identifier: Apache-2.0
#include "client/core/session_machine.h"

#include "protocol/handshake.h"
#include "protocol/limits.h"

#include <algorithm>
#include <iterator>
#include <type_traits>
#include <utility>

namespace limn {
namespace {

/// Enough to keep the server's window open without an upstream message for every small packet.
constexpr std::uint64_t kAcknowledgeEveryBytes = 16 * 1024;
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
      backoff_(options_.giveUpAfterMs, options_.seed) {
  const auto add = [this](const std::string& model) {
    streams_.emplace_back(static_cast<std::uint8_t>(streams_.size()), model, options_, outbox_);
  };
  add(options_.model);
  for (const std::string& model : options_.moreModels)
    add(model);
}

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
  outbox_.push_back(encodeMessage(protocol::Hello{limits::kProtocolVersion, options_.clientName}));
  phase_ = Phase::kGreeting;
}

void SessionMachine::onMessage(protocol::Bytes bytes, std::size_t wireBytes, std::uint64_t nowMs) {
  if (phase_ != Phase::kGreeting && phase_ != Phase::kOpening && phase_ != Phase::kStreaming)
    return;
  lastHeardMs_ = nowMs;
  if (options_.stop.kind == StopCondition::Kind::kBytes &&
      bytes_.received + wireBytes > options_.stop.bytes) {
    if (!hasAnyBase()) {
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
    return loseDamaged(message.error(), nowMs);
  }
  bytes_.count(message->body, wireBytes);
  ModelStream* stream = nullptr;
  if (const auto channel = channelOf(message->body)) {
    if (*channel >= streams_.size()) {
      return lose({ErrorCode::kProtocol, "the server used a channel that is not open"}, nowMs, 0);
    }
    stream = &streams_[*channel];
  }
  std::visit(
      [&](const auto& body) {
        if constexpr (requires { handle(*stream, body, nowMs); }) {
          handle(*stream, body, nowMs);
        } else if constexpr (requires { handle(body, nowMs); }) {
          handle(body, nowMs);
        } else if constexpr (requires { stream->take(body); }) {
          handlePayload(*stream, body, bytes.size(), nowMs);
        }
        // A Catalogue that nobody asked for does no harm.
      },
      message->body);
  if (phase_ == Phase::kStreaming) {
    noteStates(nowMs);
    checkStop();
  }
}

void SessionMachine::onClosed(const Error& reason, std::uint64_t nowMs) {
  if (phase_ == Phase::kDone || phase_ == Phase::kFailed || phase_ == Phase::kWaiting) return;
  // A server that was never reached is most likely not there: say so at once.
  if (!everWelcomed_) return failWith(reason);
  lose(reason, nowMs, 0);
}

void SessionMachine::onIdle(std::uint64_t) {
  if (phase_ == Phase::kOpening || phase_ == Phase::kStreaming) acknowledge();
}

void SessionMachine::onTimer(std::uint64_t nowMs) {
  if (phase_ == Phase::kDone || phase_ == Phase::kFailed) return;
  if (options_.stop.kind == StopCondition::Kind::kSeconds &&
      static_cast<double>(nowMs - startMs_) >= 1000.0 * options_.stop.seconds) {
    if (!hasAnyBase()) {
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
  for (ModelStream& stream : streams_)
    stream.onTimer(nowMs);
  if (owesAnswer() && nowMs >= lastHeardMs_ + options_.silenceMs) {
    const Error silent{
        ErrorCode::kNetwork,
        "the server has not answered for " + std::to_string(options_.silenceMs / 1000) + " s"};
    if (!everWelcomed_) return failWith(silent);
    lose(silent, nowMs, 0);
  }
}

void SessionMachine::setView(const ClientView& view, std::uint64_t nowMs, std::size_t model) {
  ModelStream& stream = streams_[model];
  if (view.hullFaces > 0) {
    options_.outerHullFaces = view.hullFaces;
    options_.maps = Options::Maps::kWanted;
    if (stream.isOpen()) {
      if (auto asked = stream.askForHulls(); !asked) return failWith(asked.error());
    }
  }
  if (!stream.look(view)) return;
  blocked_.reset();
  stream.tellView(nowMs);
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
  phase_ = Phase::kOpening;
  for (ModelStream& stream : streams_)
    stream.open();
}

void SessionMachine::handle(
    ModelStream& stream,
    const protocol::ModelInfo& message,
    std::uint64_t nowMs) {
  if (phase_ != Phase::kOpening || !stream.awaitsDescription()) {
    return lose(
        {ErrorCode::kProtocol, "a model's description came that was not asked for"},
        nowMs,
        0);
  }
  const bool resuming = stream.decoder().hasModel();
  if (auto begun = stream.describe(message); !begun) return loseDamaged(begun.error(), nowMs);
  if (options_.memoryBytes > 0) {
    const std::uint64_t share = options_.memoryBytes / streams_.size();
    if (auto fits = stream.limitMemory(share, message); !fits) return failWith(fits.error());
  }
  // Also when the asset has changed meanwhile: then the have-set is empty, and the server, which
  // waits for it, begins from the base mesh.
  if (resuming) stream.sendHaveSet();
  if (auto begun = stream.begin(nowMs); !begun) return failWith(begun.error());
  if (std::ranges::all_of(streams_, &ModelStream::isOpen)) phase_ = Phase::kStreaming;
  notice_.clear();
  noteProgress();
}

template <class Payload>
void SessionMachine::handlePayload(
    ModelStream& stream,
    const Payload& message,
    std::size_t messageBytes,
    std::uint64_t nowMs) {
  if (!stream.isOpen()) {
    return lose({ErrorCode::kProtocol, "mesh data came before a model was open"}, nowMs, 0);
  }
  if (auto taken = stream.take(message); !taken) return loseDamaged(taken.error(), nowMs);
  damages_ = 0;
  noteProgress();
  taken_ += messageBytes;
  if constexpr (
      std::is_same_v<Payload, protocol::Hull> || std::is_same_v<Payload, protocol::HullSplits>) {
    if (auto asked = stream.askForHulls(); !asked) return failWith(asked.error());
  }
  if constexpr (std::is_same_v<Payload, protocol::Contour>) {
    const std::size_t points = stream.decoder().contour()->lines.points.size();
    const auto answerMs = stream.noteContour(message, nowMs);
    if (!answerMs) return loseDamaged(answerMs.error(), nowMs);
    contourTimes_.answerMs.push_back(*answerMs);
    contourTimes_.points += points;
  }
  if (taken_ - acknowledged_ >= kAcknowledgeEveryBytes) acknowledge();
}

void SessionMachine::handle(
    ModelStream& stream,
    const protocol::Settled& message,
    std::uint64_t nowMs) {
  if (!stream.isOpen()) {
    return lose({ErrorCode::kProtocol, "settled came before a model was open"}, nowMs, 0);
  }
  if (message.pose != stream.newestView()) return;  // about a view that has passed
  if (auto settled = stream.settle(toState(message.state)); !settled)
    return loseDamaged(settled.error(), nowMs);
  noteProgress();
}

void SessionMachine::handle(
    ModelStream& stream,
    const protocol::Dropped& message,
    std::uint64_t nowMs) {
  if (auto dropped = stream.drop(message); !dropped) return loseDamaged(dropped.error(), nowMs);
  noteProgress();
}

void SessionMachine::handle(
    ModelStream& stream,
    const protocol::Full& message,
    std::uint64_t nowMs) {
  if (!stream.isOpen() || stream.maxSplits() == 0) {
    return lose({ErrorCode::kProtocol, "the server says full, but there is no limit"}, nowMs, 0);
  }
  if (message.pose == stream.newestView()) {
    if (auto roomier = stream.makeRoom(message.missing); !roomier) {
      blocked_ = roomier.error();
      if (options_.stop.kind == StopCondition::Kind::kState) failWith(*blocked_);
    }
  }
  noteProgress();
}

void SessionMachine::handle(const protocol::Failure& message, std::uint64_t nowMs) {
  const std::string what = message.message.empty() ? std::string(protocol::nameOf(message.code))
                                                   : std::string(message.message);
  ModelStream* stream =
      message.channel >= 0 && static_cast<std::size_t>(message.channel) < streams_.size()
          ? &streams_[static_cast<std::size_t>(message.channel)]
          : nullptr;
  switch (message.code) {
    case protocol::WireError::kNotReady:
      if (stream == nullptr) break;
      notice_ = what;
      // The channel is closed, the connection is not: the model is asked for again.
      phase_ = Phase::kOpening;
      stream->openAgainAt(nowMs + std::max<std::uint64_t>(message.retryAfterMs, kReopenMs));
      return;
    case protocol::WireError::kStale:
    case protocol::WireError::kHaveSet:
      if (stream == nullptr || !stream->decoder().hasModel()) break;
      phase_ = Phase::kOpening;
      stream->restart();
      return;
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
      break;
  }
  failWith({ErrorCode::kProtocol, what});
}

// ---- Actions

void SessionMachine::acknowledge() {
  if (taken_ == acknowledged_) return;
  acknowledged_ = taken_;
  outbox_.push_back(encodeMessage(protocol::Acknowledge{taken_}));
}

void SessionMachine::loseDamaged(const Error& reason, std::uint64_t nowMs) {
  ++damages_;
  lose(reason, nowMs, 0);
}

void SessionMachine::lose(const Error& reason, std::uint64_t nowMs, std::uint64_t retryAfterMs) {
  outbox_.clear();
  for (ModelStream& stream : streams_)
    stream.disconnect();
  if (damages_ >= kMaxDamages) return failWith(reason.within("the stream keeps arriving damaged"));
  const auto retryAtMs = backoff_.next(nowMs, retryAfterMs);
  if (!retryAtMs) {
    return failWith(reason.within("the connection was lost and did not come back"));
  }
  notice_ = "connection lost (" + reason.message + "), trying again";
  retryAtMs_ = *retryAtMs;
  phase_ = Phase::kWaiting;
}

void SessionMachine::failWith(Error error) {
  failure_ = std::move(error);
  outbox_.clear();
  phase_ = Phase::kFailed;
}

void SessionMachine::noteProgress() {
  backoff_.reset();
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

void SessionMachine::checkStop() {
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
    case Phase::kStreaming: {
      const bool isUnfinished =
          options_.stop.kind == StopCondition::Kind::kState && !hasReached(options_.stop.state);
      return std::ranges::any_of(streams_, [=](const ModelStream& stream) {
        return stream.owesAnswer() || (isUnfinished && stream.hasToldView());
      });
    }
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
  for (const ModelStream& stream : streams_) {
    if (const auto due = stream.wakeAtMs()) consider(*due);
  }
  if (owesAnswer()) consider(lastHeardMs_ + options_.silenceMs);
  if (options_.stop.kind == StopCondition::Kind::kSeconds) {
    consider(startMs_ + static_cast<std::uint64_t>(1000.0 * options_.stop.seconds + 0.999));
  }
  return wake;
}

bool SessionMachine::hasAnyBase() const {
  return std::ranges::any_of(streams_, [](const ModelStream& s) { return s.decoder().hasBase(); });
}

std::optional<std::uint32_t> SessionMachine::room(std::size_t model) const {
  const std::uint32_t most = streams_[model].maxSplits();
  return most == 0 ? std::nullopt : std::optional(most);
}

bool SessionMachine::hasReached(MeshState wanted) const {
  return std::ranges::all_of(streams_, [&](const ModelStream& stream) {
    return stream.hasReached(wanted) && (!options_.needsSeeds || stream.decoder().seedsAreThere());
  });
}

MeshState SessionMachine::state() const {
  MeshState least = MeshState::kComplete;
  for (const ModelStream& stream : streams_)
    least = std::min(least, stream.state());
  return least;
}

MeshState SessionMachine::state(std::size_t model) const {
  return streams_[model].state();
}

}  // namespace limn
