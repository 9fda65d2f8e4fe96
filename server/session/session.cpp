// SPDX-License-Identifier: Apache-2.0
#include "server/session/session.h"

#include "protocol/handshake.h"
#include "protocol/limits.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

// A client that keeps provoking errors without reading them is cut off.
constexpr std::size_t kMaxRefusals = 16;
constexpr std::uint32_t kNotReadyRetryMs = 1000;

protocol::WireError wireErrorOf(const Error& error) {
  return error.code == ErrorCode::kLimitExceeded ? protocol::WireError::kLimit
                                                 : protocol::WireError::kBadMessage;
}

}  // namespace

Session::Session(
    SessionShared& shared,
    Peer& peer,
    std::int64_t nowMs,
    std::shared_ptr<const Grant> grant)
    : shared_(shared),
      peer_(peer),
      grant_(std::move(grant)),
      bornMs_(nowMs),
      nowMs_(nowMs),
      window_({.mostBytes = shared.options.windowBytes}) {}

Session::~Session() {
  closeChannels();
}

Channel* Session::find(std::uint8_t id) {
  const auto found = std::ranges::find(channels_, id, [](const auto& c) { return c->id(); });
  return found == channels_.end() ? nullptr : found->get();
}

void Session::closeChannel(std::uint8_t id) {
  if (Channel* channel = find(id)) {
    channel->endPrefetch();
    giveBack(*channel);
  }
  std::erase_if(channels_, [id](const auto& c) { return c->id() == id; });
}

void Session::closeChannels() {
  while (!channels_.empty())
    closeChannel(channels_.back()->id());
}

void Session::refuse(protocol::WireError code, std::int16_t channel, const std::string& why) {
  if (channel >= 0) closeChannel(static_cast<std::uint8_t>(channel));
  protocol::Failure failure;
  failure.code = code;
  failure.channel = channel;
  failure.message = std::string_view(why).substr(0, limits::kMaxTextBytes);
  if (code == protocol::WireError::kNotReady) failure.retryAfterMs = kNotReadyRetryMs;
  refusals_.push_back(protocol::encodeMessage(failure));
  if (channel < 0 || refusals_.size() > kMaxRefusals) {
    close_ = Close::kProtocolError;
    closeReason_ = why;
    closeChannels();
  }
}

void Session::receive(protocol::Bytes message, std::int64_t nowMs) {
  nowMs_ = nowMs;
  if (close_) return;
  if (message.size() > limits::kMaxClientMessageBytes) {
    refuse(
        protocol::WireError::kLimit,
        -1,
        "a client's message may have " + std::to_string(limits::kMaxClientMessageBytes) + " bytes");
  } else if (const auto decoded = protocol::decodeMessage(message, protocol::Sender::kClient);
             !decoded) {
    refuse(wireErrorOf(decoded.error()), -1, decoded.error().message);
  } else if (!greeted_ && decoded->as<protocol::Hello>() == nullptr) {
    refuse(protocol::WireError::kState, -1, "the first message must be Hello");
  } else {
    if (decoded->as<protocol::Pose>() == nullptr &&
        decoded->as<protocol::Acknowledge>() == nullptr) {
      // What comes after a pose may build on it.
      for (const auto& channel : channels_)
        channel->takeHeldPoseNow(shared_.cells, nowMs_);
    }
    std::visit([this](const auto& body) { handle(body); }, decoded->body);
  }
  peer_.wantWrite();
}

void Session::refuseForLimit(const std::string& why) {
  if (close_) return;
  refuse(protocol::WireError::kLimit, -1, why);
  peer_.wantWrite();
}

bool Session::takePoses() {
  bool any = false;
  for (const auto& channel : channels_)
    any = channel->takeHeldPose(shared_.cells, nowMs_) || any;
  return any;
}

void Session::handle(const protocol::Hello& hello) {
  if (greeted_) return refuse(protocol::WireError::kState, -1, "Hello comes once");
  const auto version = protocol::negotiateVersion(hello.version);
  if (!version) return refuse(protocol::WireError::kVersion, -1, version.error().message);
  greeted_ = true;
  welcomeWanted_ = true;
}

void Session::handle(const protocol::Open& open) {
  if (find(open.channel) != nullptr) {
    return refuse(protocol::WireError::kState, open.channel, "this channel has a model open");
  }
  const std::string name(open.model);
  if (channels_.size() >= shared_.options.maxChannels) {
    return refuse(
        protocol::WireError::kLimit,
        open.channel,
        "at most " + std::to_string(shared_.options.maxChannels) + " models a connection");
  }
  // A model that may not be seen is not told from one that is not there.
  const ModelSource::Lookup lookup =
      mayOpen(name) ? shared_.models.find(name) : ModelSource::Lookup{};
  switch (lookup.availability) {
    case ModelSource::Availability::kNotFound:
      return refuse(
          protocol::WireError::kNotFound,
          open.channel,
          "no model is named '" + name + "'; GetCatalogue lists them");
    case ModelSource::Availability::kNotReady:
      return refuse(
          protocol::WireError::kNotReady,
          open.channel,
          "'" + name + "' is still being prepared");
    case ModelSource::Availability::kFailed:
      return refuse(
          protocol::WireError::kNotFound,
          open.channel,
          "'" + name + "' failed: " + lookup.reason);
    case ModelSource::Availability::kLoading:
    case ModelSource::Availability::kReady:
      break;
  }
  const std::uint32_t vertices =
      lookup.model ? lookup.model->forest().vertexCount() : lookup.vertices;
  // A newcomer is not owed what others had before it came.
  std::optional<std::uint64_t> served;
  for (const auto& other : channels_)
    served = std::min(served.value_or(other->servedBytes()), other->servedBytes());
  channels_.push_back(std::make_unique<Channel>(
      Channel::Request{open.channel, name, open.resume},
      vertices,
      shared_.options));
  channels_.back()->addServed(served.value_or(0));
  if (lookup.model) static_cast<void>(channels_.back()->setModel(lookup.model));
}

bool Session::tryLoad(Channel& channel) {
  const std::uint8_t id = channel.id();
  const ModelSource::Lookup lookup = shared_.models.find(channel.modelName());
  if (lookup.availability == ModelSource::Availability::kLoading) return true;
  if (!lookup.model) {
    refuse(
        protocol::WireError::kNotReady,
        id,
        "'" + channel.modelName() + "' cannot be opened: " +
            (lookup.reason.empty() ? "it is being prepared again" : lookup.reason));
    return false;
  }
  if (const auto set = channel.setModel(lookup.model); !set) {
    refuse(
        set.error().code == ErrorCode::kCorrupt ? protocol::WireError::kStale
                                                : protocol::WireError::kHaveSet,
        id,
        set.error().message);
    return false;
  }
  return true;
}

void Session::handle(const protocol::HaveSet& piece) {
  Channel* channel = find(piece.channel);
  if (channel == nullptr) {
    return refuse(protocol::WireError::kState, piece.channel, "no model is open on this channel");
  }
  if (const auto taken = channel->haveSet(piece); !taken) {
    refuse(
        taken.error().code == ErrorCode::kCorrupt ? protocol::WireError::kStale
                                                  : protocol::WireError::kHaveSet,
        piece.channel,
        taken.error().message);
  }
}

void Session::handle(const protocol::Pose& pose) {
  // A pose may cross the Error that closed its channel.
  Channel* channel = find(pose.channel);
  if (channel == nullptr) return;
  ++shared_.poses;
  if (!channel->pose(pose, shared_.cells, nowMs_)) ++shared_.posesReplaced;
  giveBack(*channel);
}

void Session::handle(const protocol::Acknowledge& acknowledge) {
  if (const auto taken = window_.acknowledge(acknowledge.bytes, nowMs_); !taken) {
    refuse(protocol::WireError::kBadMessage, -1, taken.error().message);
  }
}

void Session::handle(const protocol::Drop& drop) {
  Channel* channel = find(drop.channel);
  if (channel == nullptr) return;  // as for a pose
  if (const auto taken = channel->drop(drop.ids); !taken) {
    refuse(protocol::WireError::kBadMessage, drop.channel, taken.error().message);
  }
}

void Session::handle(const protocol::GetHull& request) {
  // As for a pose.
  if (Channel* channel = find(request.channel)) answer(channel->getHull(request), request.channel);
}

void Session::handle(const protocol::GetMap& request) {
  if (Channel* channel = find(request.channel)) answer(channel->getMap(request), request.channel);
}

/// Refuses a request for a hull or a map that was not taken. What the model does not have is not
/// sent, and that is all: ModelInfo said so, and a model that lost its hulls when it was prepared
/// again is still to be drawn without.
void Session::answer(const Result<void>& taken, std::uint8_t channel) {
  if (taken || taken.error().code == ErrorCode::kNotFound) return;
  refuse(protocol::WireError::kState, channel, taken.error().message);
}

void Session::handle(const protocol::GetContour& request) {
  Channel* channel = find(request.channel);
  if (channel == nullptr) return;  // as for a pose
  if (const auto taken = channel->getContour(request, shared_.cells); !taken) {
    refuse(protocol::WireError::kState, request.channel, taken.error().message);
  }
}

void Session::update(std::int64_t nowMs) {
  nowMs_ = nowMs;
  if (close_) return;
  bool more = takePoses();
  for (std::size_t i = 0; i < channels_.size();) {
    Channel& channel = *channels_[i];
    if (channel.loading()) {
      const std::size_t before = refusals_.size();
      const bool kept = tryLoad(channel);
      more = more || refusals_.size() != before || (kept && !channel.loading());
      if (!kept) continue;
    }
    more = channel.update(shared_.cells, nowMs) || more;
    giveBack(channel);
    if (channel.mayPrefetch(nowMs) && shared_.prefetch.allows(nowMs)) {
      // Before any of it is coded, so that one begins at a time.
      shared_.prefetch.spend(channel.prefetch());
      more = true;
    }
    if (channel.contourFailed()) {
      refuse(
          protocol::WireError::kLimit,
          channel.id(),
          "the contours of '" + channel.modelName() + "' are too large for a message");
      more = true;
      continue;
    }
    ++i;
  }
  if (more) peer_.wantWrite();
}

std::optional<std::int64_t> Session::dueMs() const {
  std::optional<std::int64_t> first;
  for (const auto& channel : channels_) {
    if (const auto due = channel->dueMs()) first = std::min(first.value_or(*due), *due);
  }
  return first;
}

std::optional<OutMessage> Session::nextMessage(std::int64_t nowMs) {
  nowMs_ = nowMs;
  OutMessage out;
  if (welcomeWanted_) {
    welcomeWanted_ = false;
    protocol::Welcome welcome;
    welcome.version = limits::kProtocolVersion;
    welcome.server = shared_.serverName;
    out.owned = protocol::encodeMessage(welcome);
    return out;
  }
  if (!refusals_.empty()) {
    out.owned = std::move(refusals_.front());
    refusals_.pop_front();
    return out;
  }
  if (close_) return std::nullopt;
  if (catalogueWanted_) {
    catalogueWanted_ = false;
    out.owned = catalogueMessageOf(shared_.models.catalogue(), grant_.get());
    return out;
  }
  for (const auto& channel : channels_) {
    if (channel->loading() && !tryLoad(*channel)) return nextMessage(nowMs);
  }
  static_cast<void>(takePoses());
  auto message = nextPayload();
  if (message && message->payload) window_.sent(message->bytes().size(), nowMs);
  return message;
}

/// What a picture lacks most, over all channels; among equals the channel that had least.
std::optional<OutMessage> Session::nextPayload() {
  while (true) {
    for (const auto& channel : channels_) {
      if (auto control = channel->nextControl()) return control;
    }
    const auto rank = [](const auto& channel) {
      return std::pair(channel->urgency(), channel->servedBytes());
    };
    const auto next = std::ranges::min_element(channels_, {}, rank);
    if (next == channels_.end()) return std::nullopt;
    if ((*next)->urgency() == Urgency::kNothing) {
      // At once, not with the next tick: a camera passes a cell within a few of them.
      if (!lookAhead()) return std::nullopt;
      continue;
    }
    Channel& channel = **next;
    const Urgency before = channel.urgency();
    auto message = channel.nextPayload(window_);
    if (message) {
      channel.addServed(message->bytes().size());
      giveBack(channel);
      return message;
    }
    // Nothing, as it turned out, or the window is full: then nobody else's turn comes before.
    if (channel.urgency() == before) return std::nullopt;
  }
}

bool Session::lookAhead() {
  bool any = false;
  for (const auto& channel : channels_)
    any = channel->lookAhead(shared_.cells, nowMs_) || any;
  return any;
}

void Session::drain(std::uint32_t retryAfterMs) {
  if (close_) return;
  protocol::Failure failure;
  failure.code = protocol::WireError::kDraining;
  failure.message = "the server is going down; connect again";
  failure.retryAfterMs = retryAfterMs;
  refusals_.push_back(protocol::encodeMessage(failure));
  closeChannels();
  close_ = Close::kGoingAway;
  closeReason_ = failure.message;
  peer_.wantWrite();
}

std::size_t Session::bytes() const {
  std::size_t sum = sizeof(*this);
  for (const auto& refusal : refusals_)
    sum += refusal.capacity();
  for (const auto& channel : channels_)
    sum += channel->bytes();
  return sum;
}

}  // namespace limn
