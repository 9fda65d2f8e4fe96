// SPDX-License-Identifier: Apache-2.0
#include "server/session/channel.h"

#include "protocol/limits.h"

#include "shared/codec/id_set.h"
#include "shared/codec/split_codec.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

/// Whether two poses need the same, whatever their ids and goals.
bool sameView(const protocol::Pose& a, const protocol::Pose& b) {
  return a.eye == b.eye && a.forward == b.forward && a.up == b.up && a.fovY == b.fovY &&
         a.orthoHeight == b.orthoHeight && a.width == b.width && a.height == b.height &&
         a.errorPx == b.errorPx && a.silhouette == b.silhouette;
}

}  // namespace

Channel::Channel(Request request, std::uint32_t vertexCount, const SessionOptions& options)
    : request_(std::move(request)),
      options_(options),
      have_(vertexCount),
      rng_(options.randomSeed.value_or(0)),
      awaitingHaveSet_(request_.resume) {}

Result<void> Channel::setModel(std::shared_ptr<const Model> model) {
  if (model->forest().vertexCount() != have_.vertexCount()) {
    // The name was pointed at another asset while this one was loading.
    have_ = HaveSet(model->forest().vertexCount());
    if (resumeAsset_) return fail(ErrorCode::kCorrupt, "the model has changed");
  }
  model_ = std::move(model);
  return resumeEnded_ ? finishResume() : Result<void>{};
}

Result<void> Channel::haveSet(const protocol::HaveSet& piece) {
  if (!awaitingHaveSet_ || resumeEnded_) {
    return fail(ErrorCode::kProtocol, "a HaveSet comes once, after an Open that resumes");
  }
  if (resumeAsset_ && *resumeAsset_ != piece.asset) {
    return fail(ErrorCode::kProtocol, "the pieces of a HaveSet name different assets");
  }
  if (piece.first < resumeNext_) return fail(ErrorCode::kProtocol, "HaveSet pieces out of order");
  resumeAsset_ = piece.asset;
  resumeBase_ = resumeBase_ || piece.base;
  const std::uint64_t end = std::uint64_t{piece.first} + 8 * piece.bits.size();
  resumeNext_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(end, limits::kMaxVertices));
  have_.addBits(piece.first, piece.bits);
  resumeEnded_ = piece.last;
  return piece.last && model_ ? finishResume() : Result<void>{};
}

Result<void> Channel::finishResume() {
  awaitingHaveSet_ = false;
  if (*resumeAsset_ != model_->id()) return fail(ErrorCode::kCorrupt, "the model has changed");
  const SplitForest& forest = model_->forest();
  const std::uint32_t base = forest.baseVertexCount();
  if (resumeBase_) {
    have_.addRange(0, base);
  } else if (have_.count() != 0) {
    return fail(ErrorCode::kProtocol, "the HaveSet has splits but not the base mesh");
  }
  if (resumeBase_ && !isClosed(forest, have_.words())) {
    return fail(ErrorCode::kProtocol, "the HaveSet lacks prerequisites of what it has");
  }
  baseSent_ = resumeBase_;
  return {};
}

bool Channel::resting(std::int64_t nowMs) const {
  return nowMs - poseAtMs_ >= options_.restMs;
}

void Channel::pose(const protocol::Pose& pose, ViewCells& cells, std::int64_t nowMs) {
  const bool sameEye = pose_ && sameView(*pose_, pose);
  const bool same = sameEye && pose_->goal == pose.goal;
  if (!same) jumped_ = !pose_ || sameEye || resting(nowMs);
  pose_ = pose;
  settledSent_ = false;
  completeSent_ = false;
  if (same) return;
  poseAtMs_ = nowMs;
  poseHasOwnSet_ = false;
  satisfied_ = false;
  prefetching_ = false;
  if (plan_ == Plan::kEverything) plan_ = Plan::kNothing;
  // The last set goes on as if it were a cell's, but no longer says that this pose is settled.
  if (plan_ == Plan::kPoseExact || plan_ == Plan::kPoseSettled) plan_ = Plan::kCell;
  pendingPlan_ = Plan::kCell;
  if (jumped_) {
    // Far from where the last set was for: nothing is better than what it would bring.
    plan_ = Plan::kNothing;
    target_ = nullptr;
    pending_ = nullptr;
  }
  static_cast<void>(steer(cells, nowMs));
}

Result<void> Channel::drop(protocol::Bytes ids) {
  if (!model_) return fail(ErrorCode::kProtocol, "a Drop came before the model was open");
  const auto decoded = decodeIdSet(ids, have_.vertexCount());
  if (!decoded) return fail(ErrorCode::kProtocol, decoded.error().message);
  for (const VertexId v : *decoded) {
    if (v < model_->forest().baseVertexCount() || !have_.holds(v)) {
      return fail(ErrorCode::kProtocol, "a Drop names a split that is not held");
    }
  }
  for (const VertexId v : *decoded)
    have_.remove(v);
  cursor_ = {};
  exhausted_ = false;
  satisfied_ = false;
  // It is short of memory: what it does not need it would only drop again.
  options_.prefetchAfterMs = -1;
  if (prefetching_) adopt(Plan::kNothing, nullptr);
  prefetching_ = false;
  poseHasOwnSet_ = false;
  return {};
}

void Channel::adopt(Plan plan, std::shared_ptr<const TargetSet> target) {
  plan_ = plan;
  target_ = std::move(target);
  cursor_ = {};
  exhausted_ = false;
}

bool Channel::planIsFinal() const {
  return plan_ == Plan::kPoseSettled || plan_ == Plan::kPoseExact || plan_ == Plan::kEverything;
}

/// Chooses the plan for the current pose at this moment. True when it changed.
bool Channel::steer(ViewCells& cells, std::int64_t nowMs) {
  if (!model_ || !pose_) return false;
  bool changed = false;
  if (pending_ && pending_->set) {
    adopt(pendingPlan_, pending_->set);
    pending_ = nullptr;
    changed = true;
  }
  if (options_.randomSeed || pose_->goal == protocol::Goal::kComplete || have_.complete()) {
    if (plan_ != Plan::kEverything) {
      adopt(Plan::kEverything, nullptr);
      pending_ = nullptr;
      changed = true;
    }
    return changed;
  }
  if (jumped_ || resting(nowMs)) {
    if (!poseHasOwnSet_) {
      const bool exact = pose_->goal == protocol::Goal::kExact;
      pending_ =
          cells.pose(model_, *pose_, exact ? ViewCells::Need::kExact : ViewCells::Need::kSettled);
      pendingPlan_ = exact ? Plan::kPoseExact : Plan::kPoseSettled;
      poseHasOwnSet_ = true;
    }
    return changed;
  }
  // One on its way at a time, so that a camera faster than the workers still gets some of its sets.
  if (pending_) return changed;
  const ViewCells::Ticket cell = cells.cell(model_, *pose_);
  if (cell && cell->set) {
    if (cell->set != target_) {
      adopt(Plan::kCell, cell->set);
      changed = true;
    }
  } else if (cell) {
    pending_ = cell;
    pendingPlan_ = Plan::kCell;
  }
  return changed;
}

bool Channel::update(ViewCells& cells, std::int64_t nowMs) {
  bool changed = steer(cells, nowMs);
  if (satisfied_ && settledSent_ && !prefetching_ && !have_.complete() &&
      options_.prefetchAfterMs >= 0 && nowMs - poseAtMs_ >= options_.prefetchAfterMs) {
    prefetching_ = true;
    adopt(Plan::kEverything, nullptr);
    changed = true;
  }
  return changed;
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

std::optional<OutMessage> Channel::next(const Window& window) {
  if (!model_) return std::nullopt;
  if (!infoSent_) {
    infoSent_ = true;
    protocol::ModelInfo info = model_->info();
    info.channel = request_.id;
    info.name = request_.model;
    OutMessage out;
    out.owned = protocol::encodeMessage(info);
    return out;
  }
  if (awaitingHaveSet_) return std::nullopt;
  if (auto start = nextStart(window)) return start;
  if (!baseSent_ || !blocksDone_ || !seedsSent_) return std::nullopt;  // the window is full
  // A pose that needs nothing more hears so before anything is prefetched for it.
  if (satisfied_) {
    if (auto settled = nextSettled()) return settled;
  }
  if (auto packet = nextPacket(window)) return packet;
  if (exhausted_ && planIsFinal()) satisfied_ = true;
  return satisfied_ ? nextSettled() : std::nullopt;
}

std::optional<OutMessage> Channel::nextStart(const Window& window) {
  if (!baseSent_) {
    if (!window.allows(model_->base().size())) return std::nullopt;
    baseSent_ = true;
    have_.addRange(0, model_->forest().baseVertexCount());
    return sharedMessage(model_->base());
  }
  if (auto block = nextBlock(window)) return block;
  if (blocksDone_ && !seedsSent_) {
    if (model_->seeds().empty()) {
      seedsSent_ = true;
    } else if (window.allows(model_->seeds().size())) {
      seedsSent_ = true;
      return sharedMessage(model_->seeds());
    }
  }
  return std::nullopt;
}

std::optional<OutMessage> Channel::nextBlock(const Window& window) {
  const SplitForest& forest = model_->forest();
  while (!blocksDone_) {
    if (nextBlock_ >= model_->blocks().size()) {
      blocksDone_ = true;
      break;
    }
    const std::uint32_t begin = forest.levelBegin[nextBlock_ + 1];
    const std::uint32_t end = forest.levelBegin[nextBlock_ + 2];
    const std::uint32_t held = have_.countRange(begin, end);
    if (held == end - begin) {
      ++nextBlock_;
      continue;
    }
    if (held != 0) {
      // Held in part (a resumed client that has dropped some): what is needed comes in packets, and
      // finer blocks could lack prerequisites.
      blocksDone_ = true;
      break;
    }
    const protocol::Bytes block = model_->blocks()[nextBlock_];
    if (!window.allows(block.size())) return std::nullopt;
    ++nextBlock_;
    have_.addRange(begin, end);
    return sharedMessage(block);
  }
  return std::nullopt;
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
      return nextSplitsOfAll(have_, maxSplits, cursor_);
  }
  return {};
}

std::optional<OutMessage> Channel::nextPacket(const Window& window) {
  if (!pose_ || plan_ == Plan::kNothing || exhausted_ || !window.allows(options_.packetBytes)) {
    return std::nullopt;
  }
  const double fit = static_cast<double>(options_.packetBytes) / bytesPerSplit_;
  const auto maxSplits = static_cast<std::size_t>(std::clamp(fit, 16.0, 65536.0));
  const std::vector<VertexId> ids = choose(maxSplits);
  if (ids.empty()) {
    exhausted_ = true;
    return std::nullopt;
  }
  const std::vector<std::uint8_t> splits =
      encodeSplits(model_->forest(), model_->splitModel(), ids);
  for (const VertexId v : ids)
    have_.add(v);
  const double measured = static_cast<double>(splits.size()) / static_cast<double>(ids.size());
  bytesPerSplit_ = std::max(0.25, 0.5 * (bytesPerSplit_ + measured));
  protocol::Packet packet;
  packet.channel = request_.id;
  packet.pose = pose_->id;
  packet.splits = splits;
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
