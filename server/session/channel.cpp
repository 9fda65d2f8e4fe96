// SPDX-License-Identifier: Apache-2.0
#include "server/session/channel.h"

#include "protocol/limits.h"

#include "shared/codec/id_set.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

constexpr double kPoseBurst = 16.0;  // poses that a network brings at once
constexpr std::uint32_t kNoLimit = 0xFFFFFFFF;

}  // namespace

Channel::Channel(Request request, std::uint32_t vertexCount, const SessionOptions& options)
    : request_(std::move(request)),
      options_(options),
      have_(vertexCount),
      rng_(options.randomSeed.value_or(0)),
      resumed_(request_.resume ? ResumedSet::Resumes::kYes : ResumedSet::Resumes::kNo),
      way_(options.aheadMs),
      poseRate_(options.posesPerSecond, kPoseBurst) {}

Result<void> Channel::setModel(std::shared_ptr<const Model> model) {
  if (model->forest().vertexCount() != have_.vertexCount()) {
    // The name was pointed at another asset while this one was loading.
    have_ = HaveSet(model->forest().vertexCount());
    if (resumed_.hasBegun()) return fail(ErrorCode::kCorrupt, "the model has changed");
  }
  model_ = std::move(model);
  return resumed_.hasEnded() ? finishResume() : Result<void>{};
}

Result<void> Channel::haveSet(const protocol::HaveSet& piece) {
  if (auto taken = resumed_.take(piece, have_); !taken) return taken;
  return resumed_.hasEnded() && model_ ? finishResume() : Result<void>{};
}

Result<void> Channel::finishResume() {
  const auto held = resumed_.finish(*model_, have_);
  if (!held) return tl::unexpected(held.error());
  start_.resume(*held);
  return {};
}

bool Channel::resting(std::int64_t nowMs) const {
  return nowMs - poseAtMs_ >= options_.restMs;
}

bool Channel::pose(const protocol::Pose& pose, ViewCells& cells, std::int64_t nowMs) {
  const bool lost = heldPose_.has_value();
  heldPose_ = pose;
  static_cast<void>(takeHeldPose(cells, nowMs));
  return !lost;
}

bool Channel::takeHeldPose(ViewCells& cells, std::int64_t nowMs) {
  if (!heldPose_ || !poseRate_.take(nowMs)) return false;
  takeHeldPoseNow(cells, nowMs);
  return true;
}

void Channel::takeHeldPoseNow(ViewCells& cells, std::int64_t nowMs) {
  if (heldPose_) take(*std::exchange(heldPose_, std::nullopt), cells, nowMs);
}

void Channel::take(const protocol::Pose& pose, ViewCells& cells, std::int64_t nowMs) {
  noteStay(cells, nowMs);
  const bool sameEye = pose_ && sameView(*pose_, pose);
  const bool same = sameEye && pose_->goal == pose.goal;
  if (!same) jumped_ = !pose_ || sameEye || resting(nowMs);
  pose_ = pose;
  settledSent_ = false;
  completeSent_ = false;
  full_ = false;
  fullSent_ = false;
  if (same) return;
  poseAtMs_ = nowMs;
  way_.add(pose, nowMs);
  poseCell_ = kNoCell;
  countsAsJump_ = false;
  poseHasOwnSet_ = false;
  satisfied_ = false;
  endPrefetch();
  if (plan_ == Plan::kEverything) plan_ = Plan::kNothing;
  // The last set goes on as if it were a cell's, but no longer says that this pose is settled.
  if (plan_ == Plan::kPoseExact || plan_ == Plan::kPoseSettled) plan_ = Plan::kCell;
  // What a search for one pose finds is no use to another, and cells come sooner.
  if (pendingPlan_ != Plan::kCell) pending_ = nullptr;
  pendingPlan_ = Plan::kCell;
  if (jumped_) {
    // Far from where the last set was for: nothing is better than what it would bring.
    adopt(Plan::kNothing, nullptr);
    pending_ = nullptr;
    // Who is short of memory has no room for a cell's set.
    if (model_ && pose.goal != protocol::Goal::kComplete && pose.maxSplits == 0)
      jumped_ = countsAsJump_ = cells.mayJump(*model_, pose, nowMs);
  }
  static_cast<void>(steer(cells, nowMs));
}

Result<void> Channel::drop(protocol::Bytes ids) {
  if (!model_) return fail(ErrorCode::kProtocol, "a Drop came before the model was open");
  if (droppedAnswer_) return fail(ErrorCode::kProtocol, "a Drop came before the last one's answer");
  const auto decoded = decodeIdSet(ids, have_.vertexCount());
  if (!decoded) return fail(ErrorCode::kProtocol, decoded.error().message);
  for (const VertexId v : *decoded) {
    if (v < model_->forest().baseVertexCount() || !have_.holds(v)) {
      return fail(ErrorCode::kProtocol, "a Drop names a split that is not held");
    }
  }
  const std::vector<VertexId> kept = model_->dependents().neededOf(have_, *decoded);
  for (const VertexId v : *decoded) {
    if (!std::ranges::binary_search(kept, v)) have_.remove(v);
  }
  droppedAnswer_ = encodeIdSet(kept);
  // What was passed over as held may be missing now, and what was said of this pose not be true.
  cursor_ = {};
  exhausted_ = false;
  satisfied_ = false;
  settledSent_ = false;
  completeSent_ = false;
  full_ = false;
  fullSent_ = false;
  way_.forgetWhatIsHeld();
  // It is short of memory: what it does not need it would only drop again.
  options_.prefetchAfterMs = -1;
  if (prefetching_) adopt(Plan::kNothing, nullptr);
  endPrefetch();
  // A pose's own set counts on what was held when it was searched for.
  poseHasOwnSet_ = false;
  return {};
}

Result<void> Channel::getHull(const protocol::GetHull& request) {
  if (!model_ || !infoSent_) {
    return fail(ErrorCode::kProtocol, "a GetHull came before the model's description");
  }
  return hulls_.request(request, *model_);
}

Result<void> Channel::getMap(const protocol::GetMap& request) {
  if (!model_ || !infoSent_) {
    return fail(ErrorCode::kProtocol, "a GetMap came before the model's description");
  }
  return hulls_.request(request, *model_);
}

Result<void> Channel::getContour(const protocol::GetContour& request, ViewCells& cells) {
  if (!model_ || !infoSent_) {
    return fail(ErrorCode::kProtocol, "a GetContour came before the model's description");
  }
  if (auto taken = contours_.take(request); !taken) return taken;
  static_cast<void>(contours_.update(model_, cells));
  return {};
}

std::uint32_t Channel::roomFor(std::uint32_t quarters) const {
  if (!pose_ || pose_->maxSplits == 0) return kNoLimit;
  const std::uint32_t base = model_->forest().baseVertexCount();
  const std::uint32_t held = have_.count() > base ? have_.count() - base : 0;
  const auto most = static_cast<std::uint32_t>(std::uint64_t{pose_->maxSplits} * quarters / 4);
  return most > held ? most - held : 0;
}

void Channel::adopt(Plan plan, std::shared_ptr<const TargetSet> target, ViewCell cell) {
  plan_ = plan;
  target_ = std::move(target);
  targetCell_ = cell;
  cursor_ = {};
  exhausted_ = plan == Plan::kCell && way_.isAllHeld(cell);
  full_ = false;
}

/// Goes on with what has been computed. True when there was something.
bool Channel::adoptPending() {
  if (!pending_ || !pending_->set) return false;
  adopt(pendingPlan_, pending_->set, pendingCell_);
  pending_ = nullptr;
  return true;
}

std::optional<std::int64_t> Channel::dueMs() const {
  if (loading() || heldPose_ || pending_ || cellRefused_ || way_.isAsking() || contours_.areOpen())
    return 0;
  if (!pose_ || resumed_.isAwaited() || plan_ == Plan::kEverything || poseHasOwnSet_)
    return std::nullopt;
  return jumped_ ? 0 : poseAtMs_ + options_.restMs;
}

bool Channel::mayPrefetch(std::int64_t nowMs) const {
  return satisfied_ && settledSent_ && !prefetching_ && !have_.complete() &&
         options_.prefetchAfterMs >= 0 && pose_->maxSplits == 0 &&
         nowMs - poseAtMs_ >= options_.prefetchAfterMs;
}

double Channel::prefetch() {
  prefetching_ = true;
  adopt(Plan::kEverything, nullptr);
  return have_.vertexCount() - have_.count();
}

void Channel::endPrefetch() {
  if (prefetching_) spared_ += have_.vertexCount() - have_.count();
  prefetching_ = false;
}

bool Channel::planIsFinal() const {
  return plan_ == Plan::kPoseSettled || plan_ == Plan::kPoseExact || plan_ == Plan::kEverything;
}

/// Chooses the plan for the current pose at this moment. True when it changed.
bool Channel::steer(ViewCells& cells, std::int64_t nowMs) {
  cellRefused_ = false;
  if (!model_ || !pose_ || resumed_.isAwaited()) return false;
  bool changed = adoptPending();
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
      // It is found for the mesh that the client will have then: until it is there, no more.
      adopt(Plan::kNothing, nullptr);
      if (!exact && !cells.mayAsk(*model_, *pose_)) return changed;
      pending_ = cells.pose(
          model_,
          *pose_,
          exact ? ViewCells::Need::kExact : ViewCells::Need::kSettled,
          start_.after(*model_, have_, roomFor(4)));
      pendingPlan_ = exact ? Plan::kPoseExact : Plan::kPoseSettled;
      pendingCell_ = kNoCell;
      poseHasOwnSet_ = pending_ != nullptr;
      changed = adoptPending() || changed;
    }
    return changed;
  }
  // One on its way at a time, so that a camera faster than the workers still gets some of its sets.
  if (pending_) return changed;
  if (poseCell_ == kNoCell) poseCell_ = viewCellOf(*pose_, model_->info());
  if (poseCell_ == targetCell_) return changed;
  const ViewCells::Ticket cell = cells.cell(model_, poseCell_);
  cellRefused_ = cell == nullptr;
  if (!cell) return changed;
  pending_ = cell;
  pendingPlan_ = Plan::kCell;
  pendingCell_ = poseCell_;
  return adoptPending() || changed;
}

/// A jump that was no part of a motion is none that others have to wait for.
void Channel::noteStay(ViewCells& cells, std::int64_t nowMs) {
  if (!countsAsJump_ || !resting(nowMs)) return;
  cells.giveJumpBack();
  countsAsJump_ = false;
}

bool Channel::update(ViewCells& cells, std::int64_t nowMs) {
  noteStay(cells, nowMs);
  bool changed = steer(cells, nowMs);
  changed = contours_.update(model_, cells) || changed;
  return lookAhead(cells, nowMs) || changed;
}

bool Channel::lookAhead(ViewCells& cells, std::int64_t nowMs) {
  way_.stopAsking();
  if (!model_ || !pose_ || plan_ != Plan::kCell || !exhausted_ || jumped_ || resting(nowMs) ||
      full_ || roomFor(kAheadQuarters) == 0) {
    return false;
  }
  return way_.look(model_, cells, targetCell_);
}

}  // namespace limn
