// SPDX-License-Identifier: Apache-2.0
#include "server/session/channel.h"

#include "protocol/limits.h"

#include "shared/codec/id_set.h"

#include <algorithm>
#include <utility>

namespace limn {
namespace {

/// How closely the way ahead is looked at: a cell is passed in about 0.4 s at 15 degrees a second.
constexpr std::int64_t kAheadStepMs = 150;
/// How often it is looked at whether the camera goes on along a way of which nothing is missing.
constexpr std::int64_t kAheadLookMs = 250;
/// What is nearer is sent although its piece is not whole.
constexpr std::int64_t kAheadSoonMs = 600;
constexpr double kPoseBurst = 16.0;  // poses that a network brings at once
/// What is only prefetched leaves this much of a client's room free, in quarters.
constexpr std::uint32_t kAheadQuarters = 3;
constexpr std::uint32_t kNoLimit = 0xFFFFFFFF;

}  // namespace

Channel::Channel(Request request, std::uint32_t vertexCount, const SessionOptions& options)
    : request_(std::move(request)),
      options_(options),
      have_(vertexCount),
      rng_(options.randomSeed.value_or(0)),
      awaitingHaveSet_(request_.resume),
      poseRate_(options.posesPerSecond, kPoseBurst) {
  allHeld_.fill(kNoCell);
}

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
  resumeSeeds_ = std::max(resumeSeeds_, piece.seeds);
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
  if (resumeSeeds_ > model_->seeds().size()) {
    return fail(ErrorCode::kProtocol, "the HaveSet has more seeds than there are");
  }
  baseSent_ = resumeBase_;
  seedsSent_ = resumeSeeds_;
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
  motion_.add(pose, nowMs);
  if (aheadStep_ >= 0) {
    wayIsHeld_ = ahead_.empty() && aheadStep_ >= options_.aheadMs / kAheadStepMs;
  }
  aheadStep_ = -1;
  ahead_.clear();  // what is left is found again if it lies on the new way
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
  aheadStep_ = -1;
  heldTo_ = {};
  allHeld_.fill(kNoCell);
  // It is short of memory: what it does not need it would only drop again.
  options_.prefetchAfterMs = -1;
  if (prefetching_) adopt(Plan::kNothing, nullptr);
  endPrefetch();
  // A pose's own set counts on what was held when it was searched for.
  poseHasOwnSet_ = false;
  return {};
}

bool Channel::isInView() const {
  if (!pose_) return true;
  const protocol::ModelInfo& info = model_->info();
  const View view = viewOfPose(*pose_, model_->forest().grid);
  return view.maySee((info.center - info.gridOrigin) / info.gridStep, info.radius / info.gridStep);
}

std::uint32_t Channel::roomFor(std::uint32_t quarters) const {
  if (!pose_ || pose_->maxSplits == 0) return kNoLimit;
  const std::uint32_t base = model_->forest().baseVertexCount();
  const std::uint32_t held = have_.count() > base ? have_.count() - base : 0;
  const auto most = static_cast<std::uint32_t>(std::uint64_t{pose_->maxSplits} * quarters / 4);
  return most > held ? most - held : 0;
}

std::uint32_t Channel::missing() const {
  if (!target_) return have_.vertexCount() - have_.count();
  return missingOf(*target_, have_);
}

void Channel::adopt(Plan plan, std::shared_ptr<const TargetSet> target, ViewCell cell) {
  plan_ = plan;
  target_ = std::move(target);
  targetCell_ = cell;
  cursor_ = {};
  exhausted_ = plan == Plan::kCell && isAllHeld(cell);
  full_ = false;
}

void Channel::noteAllHeld(ViewCell cell) {
  if (cell == kNoCell || isAllHeld(cell)) return;
  allHeld_[nextAllHeld_] = cell;
  nextAllHeld_ = (nextAllHeld_ + 1) % allHeld_.size();
}

bool Channel::isAllHeld(ViewCell cell) const {
  return cell != kNoCell && std::ranges::find(allHeld_, cell) != allHeld_.end();
}

/// What is held once base and level blocks are sent.
HaveSet Channel::haveAfterStart() const {
  const auto& levelBegin = model_->forest().levelBegin;
  HaveSet have = have_;
  have.addRange(0, levelBegin[1]);
  for (std::size_t block = nextBlock_; !blocksDone_ && block < model_->blocks().size(); ++block) {
    const std::uint32_t begin = levelBegin[block + 1];
    const std::uint32_t end = levelBegin[block + 2];
    const std::uint32_t held = have.countRange(begin, end);
    // As nextBlock().
    if (held == end - begin) continue;
    if (held != 0 || roomFor(4) < have.count() - have_.count() + (end - begin)) break;
    have.addRange(begin, end);
  }
  return have;
}

/// Goes on with what has been computed. True when there was something.
bool Channel::adoptPending() {
  if (!pending_ || !pending_->set) return false;
  adopt(pendingPlan_, pending_->set, pendingCell_);
  pending_ = nullptr;
  return true;
}

std::optional<std::int64_t> Channel::dueMs() const {
  if (loading() || heldPose_ || pending_ || cellRefused_ || aheadAsked_ || contour_ ||
      contourWanted_ || contourFailed_) {
    return 0;
  }
  if (!pose_ || awaitingHaveSet_ || plan_ == Plan::kEverything || poseHasOwnSet_)
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
  if (!model_ || !pose_ || awaitingHaveSet_) return false;
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
          haveAfterStart());
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

bool Channel::lookAhead(ViewCells& cells, std::int64_t nowMs) {
  aheadAsked_ = false;
  if (!model_ || !pose_ || plan_ != Plan::kCell || !exhausted_ || jumped_ || resting(nowMs) ||
      !ahead_.empty() || full_ || roomFor(kAheadQuarters) == 0) {
    return false;
  }
  const auto cellIn = [this](std::int64_t aheadMs) {
    const auto pose = motion_.at(aheadMs);
    return pose ? viewCellOf(*pose, model_->info()) : kNoCell;
  };
  if (aheadStep_ < 0) {
    const std::int64_t heldMs = heldTo_.atMs - poseAtMs_;
    const bool isKnown = heldTo_.cell != kNoCell && heldMs > 0;
    if (isKnown && wayIsHeld_ && poseAtMs_ - wayLookedAtMs_ < kAheadLookMs) return false;
    wayLookedAtMs_ = poseAtMs_;
    // Who goes on as before passes where the last way ended: what comes after that is new.
    aheadStep_ = isKnown && cellIn(heldMs) == heldTo_.cell ? heldMs / kAheadStepMs : 0;
  }
  const std::int64_t steps = options_.aheadMs / kAheadStepMs;
  const std::int64_t heldSteps = aheadStep_;
  while (aheadStep_ < steps) {
    const ViewCell cell = cellIn((aheadStep_ + 1) * kAheadStepMs);
    if (cell == kNoCell) break;
    const bool isNew = ahead_.empty() || ahead_.back().cell != cell;
    if (isNew && cell != targetCell_ && !isAllHeld(cell)) {
      const ViewCells::Ticket ticket = cells.cell(model_, cell);
      aheadAsked_ = !ticket || !ticket->set;
      if (aheadAsked_) break;  // the next update looks again
      ahead_.push_back({cell, ticket->set, {}});
    }
    ++aheadStep_;
    const WayPoint here{cell, poseAtMs_ + aheadStep_ * kAheadStepMs};
    (ahead_.empty() ? heldTo_ : ahead_.back().heldTo) = here;
  }
  // In pieces that end at the same cells for everyone; what is near does not wait for its end.
  const std::size_t least = heldSteps * kAheadStepMs > kAheadSoonMs ? 0 : 1;
  while (!aheadAsked_ && ahead_.size() > least && !endsPiece(ahead_.back().cell))
    ahead_.pop_back();
  return !ahead_.empty();
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
  changed = updateContour(cells) || changed;
  return lookAhead(cells, nowMs) || changed;
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
  if (!pose_ || awaitingHaveSet_ || !baseSent_ || !blocksDone_) return std::nullopt;
  if (full_ && !fullSent_) {
    fullSent_ = true;
    out.owned = protocol::encodeMessage(protocol::Full{request_.id, pose_->id, missing()});
    return out;
  }
  if (exhausted_ && planIsFinal()) satisfied_ = true;
  return satisfied_ ? nextSettled() : std::nullopt;
}

Urgency Channel::urgency() const {
  if (!model_ || !infoSent_ || awaitingHaveSet_) return Urgency::kNothing;
  if (!baseSent_ || !blocksDone_) return isInView() ? Urgency::kPicture : Urgency::kOutOfView;
  if (hulls_.isPending()) return Urgency::kHull;
  if (contour_ && contour_->done) return Urgency::kContour;
  if (!pose_ || plan_ == Plan::kNothing) return Urgency::kNothing;
  const bool isOpen = !exhausted_ && !full_;
  if (isOpen && !prefetching_) {
    if (plan_ == Plan::kEverything) return Urgency::kNeededAt1;
    const std::size_t finest = static_cast<std::size_t>(Urgency::kNeededAt1);
    return static_cast<Urgency>(
        std::min(static_cast<std::size_t>(Urgency::kNeededAt8) + cursor_.targetClass, finest));
  }
  if (seedsSent_ < model_->seeds().size()) return Urgency::kSeeds;
  if (!ahead_.empty() && !full_) return Urgency::kAhead;
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
  if (!baseSent_) {
    if (!window.allows(model_->base().size())) return std::nullopt;
    baseSent_ = true;
    have_.addRange(0, model_->forest().baseVertexCount());
    return sharedMessage(model_->base());
  }
  return nextBlock(window);
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

std::optional<OutMessage> Channel::nextHull(const Window& window) {
  const protocol::Bytes message = hulls_.next(*model_);
  if (!window.allows(message.size())) return std::nullopt;
  hulls_.advance();
  return sharedMessage(message);
}

Result<void> Channel::getContour(const protocol::GetContour& request, ViewCells& cells) {
  if (!model_ || !infoSent_) {
    return fail(ErrorCode::kProtocol, "a GetContour came before the model's description");
  }
  if (request.id <= contourId_) {
    return fail(ErrorCode::kProtocol, "the id of a GetContour must be above the last one's");
  }
  contourId_ = request.id;
  contourWanted_ = request;
  static_cast<void>(updateContour(cells));
  return {};
}

/// Begins work on the newest request once the last answer is on its way. True when an answer is
/// there.
bool Channel::updateContour(ViewCells& cells) {
  if (!contour_ && contourWanted_) {
    contour_ = cells.contour(model_, *contourWanted_);
    contourWanted_.reset();
  }
  if (!contour_ || !contour_->done) return false;
  contourFailed_ =
      contour_->message.empty() || contour_->message.size() > limits::kMaxServerMessageBytes;
  return true;
}

std::optional<OutMessage> Channel::nextContour(const Window& window) {
  if (!window.allows(contour_->message.size())) return std::nullopt;
  OutMessage out;
  out.payload = true;
  out.keepAlive = contour_;
  out.shared = contour_->message;
  contour_ = nullptr;
  return out;
}

std::optional<OutMessage> Channel::nextSeeds(const Window& window) {
  const std::size_t size = std::min(options_.seedPieceBytes, model_->seeds().size() - seedsSent_);
  if (!window.allows(size)) return std::nullopt;
  protocol::Seeds piece;
  piece.channel = request_.id;
  piece.seeds = model_->seeds().subspan(seedsSent_, size);
  piece.offset = static_cast<std::uint32_t>(seedsSent_);
  piece.total = static_cast<std::uint32_t>(model_->seeds().size());
  seedsSent_ += size;
  OutMessage out;
  out.payload = true;
  out.owned = protocol::encodeMessage(piece);
  return out;
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
    if (held != 0 || roomFor(4) < end - begin) {
      // Held in part (a resumed client that has dropped some), or too much for it: what is needed
      // comes in packets, and finer blocks could lack prerequisites.
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
    noteAllHeld(targetCell_);
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
  const std::size_t most = std::min(splitsAPacket(), room);
  std::vector<VertexId> ids;
  while (!ahead_.empty() && ids.size() < most) {
    ScheduleCursor cursor;
    const auto more = nextSplits(*ahead_.front().set, have_, most - ids.size(), cursor);
    ids.insert(ids.end(), more.begin(), more.end());
    if (ids.size() == most) break;  // there may be more
    noteAllHeld(ahead_.front().cell);
    heldTo_ = ahead_.front().heldTo;
    ahead_.erase(ahead_.begin());
    // What the next cell needs besides.
    for (const VertexId v : more)
      have_.add(v);
  }
  if (most == 0) ahead_.clear();
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
