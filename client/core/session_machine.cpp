// SPDX-License-Identifier: Apache-2.0
#include "client/core/session_machine.h"

#include "client/core/have_set.h"

#include "protocol/handshake.h"
#include "protocol/limits.h"

#include "shared/codec/id_set.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <type_traits>
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
/// What is dropped and comes back for the same view is needed after all.
constexpr std::uint32_t kMaxDropsAView = 8;
/// Of one Drop: its message stays well within its limit.
constexpr std::size_t kMaxDropSplits = 20'000;

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
      jitter_(options_.seed) {
  streams_.emplace_back(std::uint8_t{0}, options_.model);
  for (const std::string& model : options_.moreModels)
    streams_.emplace_back(static_cast<std::uint8_t>(streams_.size()), model);
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
  for (Stream& stream : streams_) {
    stream.isOpen = false;
    stream.settledAs.reset();
    stream.dropping.clear();
  }
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
    ++damages_;
    return lose(message.error(), nowMs, 0);
  }
  bytes_.count(message->body, wireBytes);
  Stream* stream = nullptr;
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
        } else if constexpr (requires { stream->decoder.take(body); }) {
          handlePayload(*stream, body, bytes.size(), nowMs);
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
  for (Stream& stream : streams_) {
    if (stream.reopenAtMs && nowMs >= *stream.reopenAtMs) {
      stream.reopenAtMs.reset();
      sendOpen(stream);
    }
    sendPoseIfDue(stream, nowMs);
  }
  if (owesAnswer() && nowMs >= lastHeardMs_ + options_.silenceMs) {
    const Error silent{
        ErrorCode::kNetwork,
        "the server has not answered for " + std::to_string(options_.silenceMs / 1000) + " s"};
    if (!everWelcomed_) return failWith(silent);
    lose(silent, nowMs, 0);
  }
}

void SessionMachine::setView(const ClientView& view, std::uint64_t nowMs, std::size_t model) {
  Stream& stream = streams_[model];
  if (view.hullFaces > 0) {
    options_.outerHullFaces = view.hullFaces;
    options_.maps = Options::Maps::kWanted;
    if (stream.isOpen) askForHulls(stream);
  }
  const std::uint32_t before = stream.poses.newestId();
  stream.poses.set(view);
  if (stream.poses.newestId() == before) return;
  stream.settledAs.reset();
  blocked_.reset();
  stream.drops = 0;
  stream.eviction.look(view);
  sendPoseIfDue(stream, nowMs);
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
  for (Stream& stream : streams_)
    sendOpen(stream);
}

void SessionMachine::handle(
    Stream& stream,
    const protocol::ModelInfo& message,
    std::uint64_t nowMs) {
  if (phase_ != Phase::kOpening || stream.isOpen || stream.reopenAtMs) {
    return lose(
        {ErrorCode::kProtocol, "a model's description came that was not asked for"},
        nowMs,
        0);
  }
  const bool resuming = stream.decoder.hasModel();
  if (auto begun = stream.decoder.beginModel(message); !begun) {
    ++damages_;
    return lose(begun.error(), nowMs, 0);
  }
  if (options_.memoryBytes > 0) {
    const std::uint64_t share = options_.memoryBytes / streams_.size();
    stream.maxSplits = splitsThatFit(share, message);
    if (stream.maxSplits == 0) {
      return failWith(
          {ErrorCode::kLimitExceeded,
           "'" + stream.model + "' has " + std::to_string(message.vertices) +
               " vertices, not even a beginning of it fits into the memory given: allow more"});
    }
  }
  // Also when the asset has changed meanwhile: then the have-set is empty, and the server, which
  // waits for it, begins from the base mesh.
  if (resuming) {
    for (auto& piece : encodeHaveSet(stream.decoder, stream.channel))
      outbox_.push_back(std::move(piece));
  }
  stream.isOpen = true;
  if (std::ranges::all_of(streams_, &Stream::isOpen)) phase_ = Phase::kStreaming;
  notice_.clear();
  noteProgress(nowMs);
  stream.hullAsked = {};
  stream.mapAsked = {};
  askForHulls(stream);
  if (phase_ == Phase::kFailed) return;
  stream.poses.repeat();
  sendPoseIfDue(stream, nowMs);
}

template <class Payload>
void SessionMachine::handlePayload(
    Stream& stream,
    const Payload& message,
    std::size_t messageBytes,
    std::uint64_t nowMs) {
  if (!stream.isOpen) {
    return lose({ErrorCode::kProtocol, "mesh data came before a model was open"}, nowMs, 0);
  }
  if (auto taken = stream.decoder.take(message); !taken) {
    ++damages_;
    return lose(taken.error(), nowMs, 0);
  }
  if constexpr (std::is_same_v<Payload, protocol::Base>) {
    if (stream.maxSplits > 0) stream.decoder.reserve(stream.maxSplits);
  }
  damages_ = 0;
  noteProgress(nowMs);
  taken_ += messageBytes;
  if constexpr (
      std::is_same_v<Payload, protocol::Hull> || std::is_same_v<Payload, protocol::HullSplits>) {
    askForHulls(stream);
  }
  if constexpr (std::is_same_v<Payload, protocol::Map>) {
    const auto& map = stream.decoder.maps().map(message.kind);
    const auto& hash = stream.decoder.model().mapFile(message.kind).hash;
    if (options_.cache && map && hash) options_.cache->keep(*hash, map->png);
  }
  if constexpr (std::is_same_v<Payload, protocol::Contour>) {
    noteContour(stream, message, nowMs);
    if (phase_ == Phase::kWaiting) return;
  }
  if (taken_ - acknowledged_ >= kAcknowledgeEveryBytes) acknowledge();
}

void SessionMachine::handle(Stream& stream, const protocol::Settled& message, std::uint64_t nowMs) {
  if (!stream.isOpen) {
    return lose({ErrorCode::kProtocol, "settled came before a model was open"}, nowMs, 0);
  }
  if (message.pose != stream.poses.newestId()) return;  // about a view that has passed
  const MeshState state = toState(message.state);
  if (state == MeshState::kComplete && !stream.decoder.complete()) {
    ++damages_;
    return lose(
        {ErrorCode::kProtocol, "the server says complete, but splits are missing"},
        nowMs,
        0);
  }
  if (!stream.settledAs || *stream.settledAs < state) stream.settledAs = state;
  noteProgress(nowMs);
}

void SessionMachine::handle(Stream& stream, const protocol::Dropped& message, std::uint64_t nowMs) {
  const auto kept = decodeIdSet(message.kept, std::numeric_limits<VertexId>::max());
  if (stream.dropping.empty() || !kept) {
    ++damages_;
    return lose({ErrorCode::kProtocol, "an answer to a drop that was not asked for"}, nowMs, 0);
  }
  std::vector<VertexId> gone;
  std::ranges::set_difference(stream.dropping, *kept, std::back_inserter(gone));
  stream.dropping.clear();
  if (auto undone = stream.decoder.undo(gone); !undone) {
    ++damages_;
    return lose(undone.error(), nowMs, 0);
  }
  noteProgress(nowMs);
}

void SessionMachine::handle(Stream& stream, const protocol::Full& message, std::uint64_t nowMs) {
  if (!stream.isOpen || stream.maxSplits == 0) {
    return lose({ErrorCode::kProtocol, "the server says full, but there is no limit"}, nowMs, 0);
  }
  if (message.pose == stream.poses.newestId()) makeRoom(stream, message.missing);
  noteProgress(nowMs);
}

void SessionMachine::makeRoom(Stream& stream, std::uint32_t missing) {
  if (!stream.dropping.empty()) return;  // the answer lets the server say again that it is full
  // Some more than is missing, since of what is asked for not all may go; ever more if that fails.
  const std::size_t wanted = std::min<std::size_t>(
      (std::size_t{missing} + stream.maxSplits / 16 + 1) << stream.drops,
      kMaxDropSplits);
  if (stream.drops < kMaxDropsAView) {
    stream.dropping =
        stream.eviction.choose(stream.decoder.mesh(), stream.decoder.model().grid, wanted);
  }
  ++stream.drops;
  if (!stream.dropping.empty()) {
    outbox_.push_back(encodeMessage(protocol::Drop{stream.channel, encodeIdSet(stream.dropping)}));
    return;
  }
  const std::string what = "this view of '" + stream.model + "' needs " + std::to_string(missing) +
                           " splits more than the memory given holds";
  blocked_ = Error{ErrorCode::kLimitExceeded, what + ": allow more, or a larger error in pixels"};
  if (options_.stop.kind == StopCondition::Kind::kState) failWith(*blocked_);
}

void SessionMachine::handle(const protocol::Failure& message, std::uint64_t nowMs) {
  const std::string what = message.message.empty() ? std::string(protocol::nameOf(message.code))
                                                   : std::string(message.message);
  Stream* stream =
      message.channel >= 0 && static_cast<std::size_t>(message.channel) < streams_.size()
          ? &streams_[static_cast<std::size_t>(message.channel)]
          : nullptr;
  switch (message.code) {
    case protocol::WireError::kNotReady:
      if (stream == nullptr) break;
      notice_ = what;
      // The channel is closed, the connection is not: the model is asked for again.
      phase_ = Phase::kOpening;
      stream->isOpen = false;
      stream->reopenAtMs = nowMs + std::max<std::uint64_t>(message.retryAfterMs, kReopenMs);
      return;
    case protocol::WireError::kStale:
    case protocol::WireError::kHaveSet:
      if (stream == nullptr || !stream->decoder.hasModel()) break;
      stream->decoder.drop();
      stream->settledAs.reset();
      phase_ = Phase::kOpening;
      sendOpen(*stream);
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

void SessionMachine::sendOpen(Stream& stream) {
  stream.isOpen = false;
  stream.dropping.clear();
  outbox_.push_back(
      encodeMessage(protocol::Open{stream.channel, stream.model, stream.decoder.hasModel()}));
}

void SessionMachine::sendPoseIfDue(Stream& stream, std::uint64_t nowMs) {
  if (!stream.isOpen) return;
  if (options_.contours == Options::Contours::kServer) return askForContour(stream, nowMs);
  auto pose = stream.poses.next(nowMs);
  if (!pose) return;
  pose->maxSplits = stream.maxSplits;
  outbox_.push_back(encodeMessage(*pose));
}

/// One at a time: what comes meanwhile is asked for when the answer is there, if it is the newest.
void SessionMachine::askForContour(Stream& stream, std::uint64_t nowMs) {
  const std::uint32_t newest = stream.poses.newestId();
  if (stream.contourAsked != stream.contourGot || stream.contourAsked == newest) return;
  const auto pose = stream.poses.newest();
  if (!pose) return;
  stream.contourAsked = newest;
  stream.contourAskedAtMs = nowMs;
  outbox_.push_back(encodeMessage(protocol::GetContour{
      stream.channel,
      newest,
      pose->eye,
      pose->forward,
      pose->orthoHeight > 0.0,
      pose->silhouette}));
}

void SessionMachine::noteContour(
    Stream& stream,
    const protocol::Contour& message,
    std::uint64_t nowMs) {
  if (message.id != stream.contourAsked || stream.contourGot == stream.contourAsked) {
    ++damages_;
    return lose({ErrorCode::kProtocol, "a contour came that was not asked for"}, nowMs, 0);
  }
  stream.contourGot = message.id;
  contourTimes_.answerMs.push_back(static_cast<double>(nowMs - stream.contourAskedAtMs));
  contourTimes_.points += stream.decoder.contour()->lines.points.size();
  askForContour(stream, nowMs);
}

bool SessionMachine::contourIsThere(const Stream& stream) const {
  return options_.contours == Options::Contours::kOwnMesh ||
         (stream.contourGot != 0 && stream.contourGot == stream.poses.newestId());
}

/// Of what is wanted, what is neither there nor on its way.
void SessionMachine::askForHulls(Stream& stream) {
  const auto ask = [&](protocol::HullSide side, std::uint32_t faces) {
    if (faces == 0 || phase_ == Phase::kFailed) return;
    const auto& hull = stream.decoder.model().hull;
    if (!hull || !hull->reason.empty()) {
      return failWith(
          {ErrorCode::kUnsupported,
           "'" + stream.model + "' has no hull" +
               (hull ? ", because " + hull->reason : ": prepare it again with this release")});
    }
    const HullStreams& hulls = stream.decoder.hulls();
    std::uint32_t& asked = stream.hullAsked[static_cast<std::size_t>(side)];
    const auto isThere = [&](std::uint32_t level) {
      return hulls.isThere(side, level, stream.decoder.model());
    };
    // What is on its way comes first: a request says what is held.
    if (isThere(faces) || (asked != 0 && !isThere(asked))) return;
    asked = faces;
    outbox_.push_back(
        encodeMessage(protocol::GetHull{stream.channel, side, faces, hulls.held(side)}));
  };
  ask(protocol::HullSide::kOuter, options_.outerHullFaces);
  ask(protocol::HullSide::kInner, options_.innerHullFaces);
  for (const auto kind : {protocol::MapKind::kNormals, protocol::MapKind::kColors}) {
    if (phase_ == Phase::kFailed || !wantsMap(stream, kind)) continue;
    const MapStreams& maps = stream.decoder.maps();
    bool& asked = stream.mapAsked[static_cast<std::size_t>(kind)];
    if (maps.map(kind) || asked) continue;
    if (maps.held(kind) == 0) restoreMap(stream, kind);
    if (maps.map(kind)) continue;
    asked = true;
    outbox_.push_back(encodeMessage(protocol::GetMap{stream.channel, kind, maps.held(kind)}));
  }
}

/// A map is of use to its own level only.
bool SessionMachine::wantsMap(const Stream& stream, protocol::MapKind kind) const {
  const auto& model = stream.decoder.model();
  return options_.maps == Options::Maps::kWanted && model.maps && model.mapFile(kind).bytes > 0 &&
         model.maps->faces <= options_.outerHullFaces &&
         options_.outerHullFaces < model.maps->faces + 2;
}

void SessionMachine::restoreMap(Stream& stream, protocol::MapKind kind) {
  const auto& hash = stream.decoder.model().mapFile(kind).hash;
  if (!options_.cache || !hash) return;
  // What is not what it should be is asked for, and kept in its place.
  if (auto png = options_.cache->load(*hash); !png.empty())
    static_cast<void>(stream.decoder.restoreMap(kind, std::move(png)));
}

bool SessionMachine::hullsAreThere(const Stream& stream) const {
  const auto isThere = [&](protocol::HullSide side, std::uint32_t faces) {
    return faces == 0 || stream.decoder.hulls().isThere(side, faces, stream.decoder.model());
  };
  const auto hasMap = [&](protocol::MapKind kind) {
    return !wantsMap(stream, kind) || stream.decoder.maps().map(kind);
  };
  return stream.decoder.hasModel() && hasMap(protocol::MapKind::kNormals) &&
         hasMap(protocol::MapKind::kColors) &&
         isThere(protocol::HullSide::kOuter, options_.outerHullFaces) &&
         isThere(protocol::HullSide::kInner, options_.innerHullFaces);
}

void SessionMachine::acknowledge() {
  if (taken_ == acknowledged_) return;
  acknowledged_ = taken_;
  outbox_.push_back(encodeMessage(protocol::Acknowledge{taken_}));
}

void SessionMachine::lose(const Error& reason, std::uint64_t nowMs, std::uint64_t retryAfterMs) {
  outbox_.clear();
  for (Stream& stream : streams_) {
    stream.isOpen = false;
    stream.reopenAtMs.reset();
    stream.settledAs.reset();
    stream.contourAsked = stream.contourGot;
  }
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
    case Phase::kStreaming:
      return std::ranges::any_of(streams_, [this](const Stream& stream) {
        return owesAnswer(stream);
      });
    default:
      return false;
  }
}

bool SessionMachine::owesAnswer(const Stream& stream) const {
  if (!stream.isOpen) return !stream.reopenAtMs;
  // The base mesh is owed from the start; more only for a view that has been told.
  if (!stream.decoder.hasBase()) return true;
  if (stream.poses.newestId() == 0) return false;
  if (options_.contours == Options::Contours::kServer) {
    return !contourIsThere(stream) || !hullsAreThere(stream);
  }
  return stateOf(stream) < MeshState::kSettled ||
         (options_.stop.kind == StopCondition::Kind::kState && !hasReached(options_.stop.state));
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
  for (const Stream& stream : streams_) {
    if (stream.reopenAtMs) consider(*stream.reopenAtMs);
    const bool tellsPoses = stream.isOpen && options_.contours == Options::Contours::kOwnMesh;
    if (tellsPoses && stream.poses.dueAtMs()) consider(*stream.poses.dueAtMs());
  }
  if (owesAnswer()) consider(lastHeardMs_ + options_.silenceMs);
  if (options_.stop.kind == StopCondition::Kind::kSeconds) {
    consider(startMs_ + static_cast<std::uint64_t>(1000.0 * options_.stop.seconds + 0.999));
  }
  return wake;
}

bool SessionMachine::hasAnyBase() const {
  return std::ranges::any_of(streams_, [](const Stream& s) { return s.decoder.hasBase(); });
}

std::optional<std::uint32_t> SessionMachine::room(std::size_t model) const {
  const std::uint32_t most = streams_[model].maxSplits;
  return most == 0 ? std::nullopt : std::optional(most);
}

bool SessionMachine::hasReached(MeshState wanted) const {
  return std::ranges::all_of(streams_, [&](const Stream& stream) {
    return stateOf(stream) >= wanted && (!options_.needsSeeds || stream.decoder.seedsAreThere()) &&
           hullsAreThere(stream) && contourIsThere(stream);
  });
}

MeshState SessionMachine::state() const {
  MeshState least = MeshState::kComplete;
  for (const Stream& stream : streams_)
    least = std::min(least, stateOf(stream));
  return least;
}

MeshState SessionMachine::state(std::size_t model) const {
  return stateOf(streams_[model]);
}

MeshState SessionMachine::stateOf(const Stream& stream) {
  const StreamDecoder& decoder = stream.decoder;
  if (!decoder.hasBase()) return MeshState::kNothing;
  if (decoder.complete()) return MeshState::kComplete;
  if (stream.settledAs) return *stream.settledAs;
  return decoder.mesh().splitsHeld() == 0 ? MeshState::kBase : MeshState::kPartial;
}

}  // namespace limn
