// SPDX-License-Identifier: Apache-2.0
#include "client/load/light_client.h"

#include "protocol/limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <variant>

namespace limn::load {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kFloodIntervalMs = 1.0;
constexpr double kRubbishIntervalMs = 50.0;
constexpr double kReturnAfterMs = 200.0;
constexpr std::size_t kRememberedPoses = 256;
// Consecutive clients start this part of a turn apart: the golden ratio spreads any number evenly.
constexpr double kStartSpread = 0.6180339887498949;

// Keys of SharedDigests; level blocks follow kLevels, pieces of the seeds kSeeds.
constexpr int kCoder = 0;  // the part of ModelInfo that two names of one asset share
constexpr int kBase = 1;
constexpr int kFeatures = 2;
constexpr int kLevels = 16;
constexpr int kSeeds = 1000;

}  // namespace

bool SharedDigests::matches(const Sha256Digest& asset, int section, protocol::Bytes bytes) {
  const Sha256Digest digest = sha256(bytes);
  const auto [entry, isNew] = digests_.try_emplace({asset, section}, digest);
  return isNew || entry->second == digest;
}

LightClient::LightClient(Plan plan, SharedDigests& digests, Counters& counters)
    : plan_(std::move(plan)),
      digests_(digests),
      counters_(counters),
      rng_(0x11D0 + plan_.index),
      attemptMs_(plan_.startMs),
      plannedMs_(plan_.startMs) {
  ++counters_.asked;
}

bool LightClient::mayBeThrownOut() const {
  return plan_.phase->behaviour == Behaviour::kFlood ||
         plan_.phase->behaviour == Behaviour::kMalformed;
}

double LightClient::nextDueMs() const {
  double due = plan_.endMs;
  switch (state_) {
    case State::kWaiting:
      due = std::min(due, attemptMs_);
      break;
    case State::kConnecting:
    case State::kOpening:
      break;
    case State::kStreaming:
      due = std::min({due, nextPoseMs_, leaveMs_});
      break;
    case State::kFinished:
      return kNever;
  }
  return due;
}

void LightClient::tick(double nowMs) {
  if (state_ == State::kFinished) return;
  if (nowMs >= plan_.endMs) {
    const bool online = state_ != State::kWaiting;
    finish(reachedBase_ || mayBeThrownOut() ? "" : "the phase ended before the base mesh came");
    if (online) wish_ = Wish::kDisconnect;
    return;
  }
  if (state_ == State::kWaiting && nowMs >= attemptMs_) {
    state_ = State::kConnecting;
    wish_ = Wish::kConnect;
    return;
  }
  if (state_ != State::kStreaming) return;
  if (nowMs >= leaveMs_) {
    ++counters_.reconnects;
    restartAfter(nowMs, 0.0);
    wish_ = Wish::kAbort;
    return;
  }
  switch (plan_.phase->behaviour) {
    case Behaviour::kMalformed:
      if (nowMs >= nextPoseMs_) {
        sendRubbish();
        nextPoseMs_ = nowMs + kRubbishIntervalMs;
      }
      return;
    case Behaviour::kFlood:
      while (nextPoseMs_ <= nowMs) {
        sendPose(nextPoseMs_);
        if (nextPoseId_ % 16 == 0) send(protocol::GetCatalogue{});
        nextPoseMs_ += kFloodIntervalMs;
      }
      return;
    case Behaviour::kIdle:
      if (nextPoseMs_ <= nowMs) sendPose(nextPoseMs_);
      nextPoseMs_ = kNever;
      return;
    case Behaviour::kNormal:
    case Behaviour::kSlowReader:
    case Behaviour::kChurn:
      while (nextPoseMs_ <= nowMs) {
        sendPose(nextPoseMs_);
        nextPoseMs_ += 1000.0 / plan_.phase->rateHz;
      }
      return;
  }
}

void LightClient::opened(double nowMs) {
  static_cast<void>(nowMs);
  if (state_ != State::kConnecting) return;
  openChannels();
  send(protocol::Hello{limits::kProtocolVersion, "limn-load"});
}

void LightClient::openChannels() {
  for (Channel& channel : channels_) {
    // Also when the last attempt did not come as far as a ModelInfo.
    channel.resuming = channel.decoder && (channel.asset || channel.resuming);
    channel.asset.reset();
    if (!channel.resuming) channel.baseHere = false;
  }
  if (!channels_.empty()) return;
  channels_.emplace_back().model = plan_.phase->model;
  for (const std::string& model : plan_.phase->also)
    channels_.emplace_back().model = model;
  for (Channel& channel : channels_) {
    if (plan_.makeDecoder) channel.decoder = plan_.makeDecoder();
  }
}

void LightClient::received(std::span<const std::uint8_t> bytes, double nowMs) {
  if (state_ == State::kFinished) return;
  counters_.bytesReceived += bytes.size();
  ++counters_.messages;
  if (plan_.phase->linkKbps > 0.0) {
    const double transferMs = static_cast<double>(bytes.size()) * 8.0 / plan_.phase->linkKbps;
    readableAtMs_ = std::max(readableAtMs_, nowMs) + transferMs;
  }
  const auto message = protocol::decodeMessage(bytes, protocol::Sender::kServer);
  if (!message) {
    decodeError(message.error().message);
    return;
  }
  handle(*message, nowMs);
  if (state_ == State::kFinished) return;
  const auto channel = protocol::channelOf(message->body);
  if (channel && *channel < channels_.size() && channels_[*channel].decoder) {
    const auto splits = channels_[*channel].decoder->decode(*message);
    if (!splits) {
      decodeError(splits.error().message);
      return;
    }
    counters_.splitsDecoded += *splits;
    if (message->as<protocol::ModelInfo>() != nullptr) resume(channels_[*channel], *channel);
  }
  if (protocol::isPayload(message->body)) {
    acknowledged_ += bytes.size();
    send(protocol::Acknowledge{acknowledged_});
  }
}

void LightClient::handle(const protocol::Message& message, double nowMs) {
  const auto index = protocol::channelOf(message.body);
  if (index && *index >= channels_.size()) {
    // A malformed Open may have been a good one, of another channel.
    if (mayBeThrownOut()) return;
    return decodeError("a channel that is not open");
  }
  Channel* const channel = index ? &channels_[*index] : nullptr;
  std::visit(
      [&](const auto& body) {
        using T = std::decay_t<decltype(body)>;
        if constexpr (std::is_same_v<T, protocol::Welcome>) {
          if (state_ != State::kConnecting) return decodeError("a second Welcome");
          counters_.connect.add(nowMs - plannedMs_);
          state_ = State::kOpening;
          for (std::size_t c = 0; c < channels_.size(); ++c)
            send(protocol::Open{
                static_cast<std::uint8_t>(c),
                channels_[c].model,
                channels_[c].resuming});
        } else if constexpr (std::is_same_v<T, protocol::ModelInfo>) {
          handleInfo(body, nowMs);
        } else if constexpr (std::is_same_v<T, protocol::Base>) {
          checkShared(*channel, kBase, body.draco);
          checkShared(*channel, kFeatures, body.features);
          if (channel->baseHere) return decodeError("a second Base");
          channel->baseHere = true;
          if (!std::ranges::all_of(channels_, &Channel::baseHere)) return;
          counters_.base.add(nowMs - plannedMs_);
          if (!reachedBase_) ++counters_.connected;
          reachedBase_ = true;
        } else if constexpr (std::is_same_v<T, protocol::LevelBlock>) {
          checkShared(*channel, kLevels + body.level, body.splits);
        } else if constexpr (std::is_same_v<T, protocol::Seeds>) {
          checkShared(*channel, kSeeds + static_cast<int>(body.offset), body.seeds);
        } else if constexpr (std::is_same_v<T, protocol::Packet>) {
          if (!channel->baseHere) return decodeError("a Packet before the base mesh");
          answer(body.pose, nowMs, std::nullopt);
        } else if constexpr (std::is_same_v<T, protocol::Settled>) {
          answer(body.pose, nowMs, body.state);
        } else if constexpr (std::is_same_v<T, protocol::Failure>) {
          // What a hostile client is told is not news.
          if (mayBeThrownOut()) return;
          // A server that has just started still opens its models. The latencies keep counting from
          // the planned start.
          const bool goesOn = body.code == protocol::WireError::kNotReady ||
                              (body.code == protocol::WireError::kDraining && mayReturn());
          if (goesOn && body.retryAfterMs > 0) {
            ++counters_.reconnects;
            const double plannedMs = plannedMs_;
            restartAfter(nowMs, body.retryAfterMs);
            plannedMs_ = plannedMs;
            wish_ = Wish::kAbort;
            return;
          }
          finish(
              "server: " + std::string(protocol::nameOf(body.code)) + ": " +
              std::string(body.message));
          wish_ = Wish::kDisconnect;
        }
      },
      message.body);
}

void LightClient::handleInfo(const protocol::ModelInfo& info, double nowMs) {
  Channel& channel = channels_[info.channel];
  if (state_ != State::kOpening || channel.asset) {
    return decodeError("a ModelInfo that nobody asked for");
  }
  if (info.name != channel.model) return decodeError("the ModelInfo of another model");
  channel.asset = info.asset;
  channel.sphere = {info.center, info.radius};
  checkShared(channel, kCoder, info.splitModel);
  if (!std::ranges::all_of(channels_, [](const Channel& c) { return c.asset.has_value(); })) return;
  state_ = State::kStreaming;
  nextPoseMs_ = nowMs;
  if (firstPoseMs_ == 0.0) firstPoseMs_ = nowMs;
  leaveMs_ = plan_.phase->behaviour == Behaviour::kChurn ? nowMs + 1000.0 + 2000.0 * rng_.uniform()
                                                         : kNever;
}

void LightClient::resume(const Channel& channel, std::uint8_t id) {
  if (!channel.resuming) return;
  if (id == 0) ++counters_.resumed;  // a client, however many models it has open
  for (auto& piece : channel.decoder->haveSet(id))
    outgoing_.push_back(std::move(piece));
}

void LightClient::checkShared(const Channel& channel, int section, protocol::Bytes bytes) {
  if (!channel.asset) return decodeError("a section before its ModelInfo");
  if (!digests_.matches(*channel.asset, section, bytes)) {
    decodeError("the same section has other bytes than another client received");
  }
}

void LightClient::answer(std::uint32_t pose, double nowMs, std::optional<protocol::Goal> settled) {
  if (pose >= nextPoseId_) return decodeError("an answer to a pose that was never sent");
  const auto found = std::find_if(poses_.begin(), poses_.end(), [&](const SentPose& sent) {
    return sent.id == pose;
  });
  if (found == poses_.end()) return;
  if (!found->answered) {
    found->answered = true;
    if (plan_.phase->measured) {
      counters_.poseToPacket.add(nowMs - found->plannedMs);
      counters_.poseToPacketBytes.add(static_cast<double>(acknowledged_ - found->payloadBefore));
    }
  }
  if (settled && found->settled < channels_.size() && ++found->settled == channels_.size()) {
    if (plan_.phase->measured) counters_.settled.add(nowMs - found->plannedMs);
  }
}

void LightClient::closed(const std::string& reason, double nowMs) {
  if (state_ == State::kFinished || state_ == State::kWaiting) return;
  if (mayBeThrownOut() || mayReturn()) {
    ++counters_.reconnects;
    restartAfter(nowMs, kReturnAfterMs * (1.0 + rng_.uniform()));
    return;
  }
  if (reachedBase_) {
    ++counters_.dropped;
    counters_.note("dropped: " + reason);
    state_ = State::kFinished;
  } else {
    finish(reason);
  }
}

void LightClient::restartAfter(double nowMs, double pauseMs) {
  state_ = State::kWaiting;
  attemptMs_ = nowMs + pauseMs;
  plannedMs_ = attemptMs_;
  readableAtMs_ = 0.0;
  if (!plan_.phase->returns) channels_.clear();
  nextPoseId_ = 1;
  acknowledged_ = 0;
  poses_.clear();
  outgoing_.clear();
}

void LightClient::finish(const std::string& failure) {
  state_ = State::kFinished;
  if (failure.empty()) return;
  if (reachedBase_) {
    ++counters_.dropped;
  } else {
    ++counters_.failed;
  }
  counters_.note(failure);
}

void LightClient::decodeError(const std::string& what) {
  ++counters_.decodeErrors;
  finish("undecodable: " + what);
  wish_ = Wish::kDisconnect;
}

void LightClient::sendPose(double plannedMs) {
  const Phase& phase = *plan_.phase;
  protocol::Pose pose;
  pose.id = nextPoseId_++;
  pose.width = phase.width;
  pose.height = phase.height;
  pose.errorPx = static_cast<float>(phase.errorPx);
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const Camera camera = cameraAt(channels_[c], plannedMs);
    pose.channel = static_cast<std::uint8_t>(c);
    pose.eye = camera.eye;
    pose.forward = camera.forward();
    pose.up = camera.up;
    pose.fovY = static_cast<float>(camera.fovDegrees * std::numbers::pi / 180.0);
    pose.orthoHeight = camera.orthographic
                           ? 2.0 * glm::length(camera.target - camera.eye) *
                                 std::tan(0.5 * camera.fovDegrees * std::numbers::pi / 180.0)
                           : 0.0;
    send(pose);
  }
  ++counters_.posesSent;
  poses_.push_back({pose.id, plannedMs, acknowledged_, false, 0});
  if (poses_.size() > kRememberedPoses) poses_.pop_front();
}

void LightClient::sendRubbish() {
  std::vector<std::uint8_t> bytes(1 + rng_.below(256));
  for (std::uint8_t& byte : bytes)
    byte = static_cast<std::uint8_t>(rng_.next());
  // Every other one is a good message with one bit flipped, which gets further into a decoder.
  if (rng_.below(2) == 0) {
    bytes = protocol::encodeMessage(protocol::Open{0, plan_.phase->model, false});
    bytes[rng_.below(static_cast<std::uint32_t>(bytes.size()))] ^=
        static_cast<std::uint8_t>(1u << rng_.below(8));
  }
  outgoing_.push_back(std::move(bytes));
}

Camera LightClient::cameraAt(const Channel& channel, double nowMs) const {
  const Phase& phase = *plan_.phase;
  const double seconds = (nowMs - firstPoseMs_) / 1000.0;
  if (phase.recorded.empty()) {
    const double start = 360.0 * std::fmod(kStartSpread * plan_.index, 1.0);
    return orbitCamera(
        channel.sphere,
        start + phase.speedDegreesPerSecond * seconds,
        phase.elevationDegrees,
        phase.distanceRadii,
        phase.fovDegrees);
  }
  // Played in a loop; the last camera stands as long as the step before it.
  const RecordedPath& path = phase.recorded;
  const double lastStep =
      path.size() > 1 ? path.back().seconds - path[path.size() - 2].seconds : 1.0;
  return limn::cameraAt(path, std::fmod(std::max(seconds, 0.0), durationOf(path) + lastStep));
}

}  // namespace limn::load
