// SPDX-License-Identifier: Apache-2.0
//
// What a channel sends next.
#include "server/session/channel.h"

#include <algorithm>
#include <utility>

namespace limn {

bool Channel::isInView() const {
  if (!pose_) return true;
  const protocol::ModelInfo& info = model_->info();
  const View view = viewOfPose(*pose_, model_->forest().grid);
  return view.maySee((info.center - info.gridOrigin) / info.gridStep, info.radius / info.gridStep);
}

std::uint32_t Channel::missing() const {
  if (!target_) return have_.vertexCount() - have_.count();
  return missingOf(*target_, have_);
}

OutMessage Channel::sharedMessage(protocol::Bytes message) const {
  OutMessage out;
  out.payload = true;
  if (request_.id == 0) {
    out.keepAlive = model_;
    out.shared = message;
  } else {
    out.owned = withChannel(message, request_.id);
  }
  return out;
}

std::optional<OutMessage> Channel::nextControl() {
  if (!model_) return std::nullopt;
  OutMessage out;
  if (!infoSent_) {
    infoSent_ = true;
    protocol::ModelInfo info = model_->info();
    info.channel = request_.id;
    info.name = request_.model;
    info.seedBytes = static_cast<std::uint32_t>(model_->seeds().size());
    out.owned = protocol::encodeMessage(info);
    return out;
  }
  if (droppedAnswer_) {
    const std::vector<std::uint8_t> kept = *std::exchange(droppedAnswer_, std::nullopt);
    out.owned = protocol::encodeMessage(protocol::Dropped{request_.id, kept});
    return out;
  }
  if (!pose_ || resumed_.isAwaited() || !start_.isThrough()) return std::nullopt;
  if (full_ && !fullSent_) {
    fullSent_ = true;
    out.owned = protocol::encodeMessage(protocol::Full{request_.id, pose_->id, missing()});
    return out;
  }
  if (exhausted_ && planIsFinal()) satisfied_ = true;
  return satisfied_ ? nextSettled() : std::nullopt;
}

Urgency Channel::urgency() const {
  if (!model_ || !infoSent_ || resumed_.isAwaited()) return Urgency::kNothing;
  if (!start_.isThrough()) return isInView() ? Urgency::kPicture : Urgency::kOutOfView;
  if (hulls_.isPending()) return Urgency::kHull;
  if (contours_.isAnswered()) return Urgency::kContour;
  if (!pose_ || plan_ == Plan::kNothing) return Urgency::kNothing;
  const bool isOpen = !exhausted_ && !full_;
  if (isOpen && !prefetching_) {
    if (plan_ == Plan::kEverything) return Urgency::kNeededAt1;
    const std::size_t finest = static_cast<std::size_t>(Urgency::kNeededAt1);
    return static_cast<Urgency>(
        std::min(static_cast<std::size_t>(Urgency::kNeededAt8) + cursor_.targetClass, finest));
  }
  if (!start_.seedsAreThrough(*model_)) return Urgency::kSeeds;
  if (!way_.isEmpty() && !full_) return Urgency::kAhead;
  return isOpen ? Urgency::kEverything : Urgency::kNothing;
}

std::optional<OutMessage> Channel::nextPayload(const Window& window) {
  switch (urgency()) {
    case Urgency::kPicture:
    case Urgency::kOutOfView:
      return nextStart(window);
    case Urgency::kHull:
      return nextHull(window);
    case Urgency::kContour:
      return nextContour(window);
    case Urgency::kNeededAt8:
    case Urgency::kNeededAt4:
    case Urgency::kNeededAt2:
    case Urgency::kNeededAt1:
    case Urgency::kEverything:
      return nextNeeded(window);
    case Urgency::kSeeds:
      return nextSeeds(window);
    case Urgency::kAhead:
      return nextAhead(window);
    case Urgency::kNothing:
      return std::nullopt;
  }
  return std::nullopt;
}

std::optional<OutMessage> Channel::nextStart(const Window& window) {
  const auto message = start_.next(*model_, have_, roomFor(4), window);
  if (!message) return std::nullopt;
  return sharedMessage(*message);
}

std::optional<OutMessage> Channel::nextHull(const Window& window) {
  const protocol::Bytes message = hulls_.next(*model_);
  if (!window.allows(message.size())) return std::nullopt;
  hulls_.advance();
  return sharedMessage(message);
}

std::optional<OutMessage> Channel::nextContour(const Window& window) {
  if (!window.allows(contours_.answerBytes())) return std::nullopt;
  const ViewCells::ContourTicket answer = contours_.takeAnswer();
  OutMessage out;
  out.payload = true;
  out.keepAlive = answer;
  out.shared = answer->message;
  return out;
}

std::optional<OutMessage> Channel::nextSeeds(const Window& window) {
  auto piece = start_.nextSeeds(*model_, options_.seedPieceBytes, window);
  if (!piece) return std::nullopt;
  piece->channel = request_.id;
  OutMessage out;
  out.payload = true;
  out.owned = protocol::encodeMessage(*piece);
  return out;
}

std::vector<VertexId> Channel::choose(std::size_t maxSplits) {
  if (options_.randomSeed) return randomSplits(model_->forest(), have_, maxSplits, rng_);
  switch (plan_) {
    case Plan::kNothing:
      return {};
    case Plan::kCell:
    case Plan::kPoseSettled:
    case Plan::kPoseExact:
      return nextSplits(*target_, have_, maxSplits, cursor_);
    case Plan::kEverything:
      return beforeUntouchedRun(nextSplitsOfAll(have_, maxSplits, cursor_));
  }
  return {};
}

std::vector<VertexId> Channel::beforeUntouchedRun(std::vector<VertexId> ids) const {
  if (ids.empty()) return ids;
  const auto& runs = model_->runs();
  auto run = std::ranges::upper_bound(runs, ids.front(), {}, &Model::Run::begin);
  for (; run != runs.end() && run->begin <= ids.back(); ++run) {
    if (have_.countRange(run->begin, run->end) != 0) continue;
    ids.erase(std::ranges::lower_bound(ids, run->begin), ids.end());
    break;
  }
  return ids;
}

std::size_t Channel::splitsAPacket() const {
  const double fit = static_cast<double>(options_.packetBytes) / bytesPerSplit_;
  return static_cast<std::size_t>(std::clamp(fit, 16.0, 65536.0));
}

std::optional<OutMessage> Channel::nextNeeded(const Window& window) {
  if (!window.allows(options_.packetBytes)) return std::nullopt;
  const std::size_t room = roomFor(4);
  if (const Model::Run* run = nextRun(); run != nullptr && run->end - run->begin <= room) {
    if (!window.allows(run->splits.size() + run->attributes.size())) return std::nullopt;
    return packetOf(*run);
  }
  // With no room left it still matters whether anything is missing.
  const std::size_t most = std::max<std::size_t>(std::min(splitsAPacket(), room), 1);
  const std::vector<VertexId> ids = choose(most);
  if (ids.size() > room) {
    full_ = true;
    return std::nullopt;
  }
  if (ids.size() < most && plan_ == Plan::kCell) {
    exhausted_ = true;
    way_.noteAllHeld(targetCell_);
  }
  if (ids.empty()) {
    exhausted_ = true;
    return std::nullopt;
  }
  return packetOf(ids);
}

std::optional<OutMessage> Channel::nextAhead(const Window& window) {
  // Half of the window stays free for what the next pose needs.
  if (!window.allows(window.limitBytes() / 2 + options_.packetBytes)) return std::nullopt;
  const std::size_t room = roomFor(kAheadQuarters);
  std::vector<VertexId> ids = way_.next(have_, std::min(splitsAPacket(), room));
  if (ids.empty()) return std::nullopt;
  std::ranges::sort(ids);
  return packetOf(ids);
}

const Model::Run* Channel::nextRun() const {
  if (plan_ != Plan::kEverything || options_.randomSeed) return nullptr;
  ScheduleCursor cursor = cursor_;
  const std::vector<VertexId> first = nextSplitsOfAll(have_, 1, cursor);
  if (first.empty()) return nullptr;
  const auto& runs = model_->runs();
  const auto run = std::ranges::lower_bound(runs, first.front(), {}, &Model::Run::begin);
  if (run == runs.end() || run->begin != first.front()) return nullptr;
  return have_.countRange(run->begin, run->end) == 0 ? &*run : nullptr;
}

OutMessage Channel::packetOf(const Model::Run& run) {
  have_.addRange(run.begin, run.end);
  return packetOf(run.splits, run.attributes);
}

OutMessage Channel::packetOf(const std::vector<VertexId>& ids) {
  PacketMaker& packets = model_->packets();
  const std::uint64_t kept = packets.hits();
  const auto coded = packets.packet(ids);
  if (prefetching_ && packets.hits() != kept) spared_ += ids.size();
  for (const VertexId v : ids)
    have_.add(v);
  const double measured = static_cast<double>(coded->bytes()) / static_cast<double>(ids.size());
  bytesPerSplit_ = std::max(0.25, 0.5 * (bytesPerSplit_ + measured));
  return packetOf(coded->splits, coded->attributes);
}

OutMessage Channel::packetOf(protocol::Bytes splits, protocol::Bytes attributes) const {
  protocol::Packet packet;
  packet.channel = request_.id;
  packet.pose = pose_->id;
  packet.splits = splits;
  packet.attributes = attributes;
  OutMessage out;
  out.payload = true;
  out.owned = protocol::encodeMessage(packet);
  return out;
}

std::optional<OutMessage> Channel::nextSettled() {
  if (!pose_) return std::nullopt;
  protocol::Settled settled;
  settled.channel = request_.id;
  settled.pose = pose_->id;
  if (!settledSent_ && pose_->goal != protocol::Goal::kComplete) {
    settledSent_ = true;
    settled.state = pose_->goal;
  } else if (have_.complete() && !completeSent_) {
    settledSent_ = true;
    completeSent_ = true;
    settled.state = protocol::Goal::kComplete;
  } else {
    return std::nullopt;
  }
  OutMessage out;
  out.owned = protocol::encodeMessage(settled);
  return out;
}

}  // namespace limn
