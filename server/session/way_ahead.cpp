// SPDX-License-Identifier: Apache-2.0
#include "server/session/way_ahead.h"

#include "server/session/scheduler.h"

#include <algorithm>

namespace limn {
namespace {

/// How closely the way ahead is looked at: a cell is passed in about 0.4 s at 15 degrees a second.
constexpr std::int64_t kStepMs = 150;
/// How often it is looked at whether the camera goes on along a way of which nothing is missing.
constexpr std::int64_t kLookMs = 250;
/// What is nearer is sent although its piece is not whole.
constexpr std::int64_t kSoonMs = 600;

}  // namespace

void WayAhead::add(const protocol::Pose& pose, std::int64_t nowMs) {
  poseAtMs_ = nowMs;
  motion_.add(pose, nowMs);
  if (step_ >= 0) isHeld_ = ahead_.empty() && step_ >= forMs_ / kStepMs;
  step_ = -1;
  ahead_.clear();  // what is left is found again if it lies on the new way
}

void WayAhead::forgetWhatIsHeld() {
  step_ = -1;
  heldTo_ = {};
  allHeld_.fill(kNoCell);
}

ViewCell WayAhead::cellIn(std::int64_t aheadMs, const Model& model) const {
  const auto pose = motion_.at(aheadMs);
  return pose ? viewCellOf(*pose, model.info()) : kNoCell;
}

bool WayAhead::look(const std::shared_ptr<const Model>& model, ViewCells& cells, ViewCell target) {
  if (!ahead_.empty()) return false;
  if (step_ < 0) {
    const std::int64_t heldMs = heldTo_.atMs - poseAtMs_;
    const bool isKnown = heldTo_.cell != kNoCell && heldMs > 0;
    if (isKnown && isHeld_ && poseAtMs_ - lookedAtMs_ < kLookMs) return false;
    lookedAtMs_ = poseAtMs_;
    // Who goes on as before passes where the last way ended: what comes after that is new.
    step_ = isKnown && cellIn(heldMs, *model) == heldTo_.cell ? heldMs / kStepMs : 0;
  }
  const std::int64_t steps = forMs_ / kStepMs;
  const std::int64_t heldSteps = step_;
  while (step_ < steps) {
    const ViewCell cell = cellIn((step_ + 1) * kStepMs, *model);
    if (cell == kNoCell) break;
    const bool isNew = ahead_.empty() || ahead_.back().cell != cell;
    if (isNew && cell != target && !isAllHeld(cell)) {
      const ViewCells::Ticket ticket = cells.cell(model, cell);
      isAsking_ = !ticket || !ticket->set;
      if (isAsking_) break;  // the next update looks again
      ahead_.push_back({cell, ticket->set, {}});
    }
    ++step_;
    const WayPoint here{cell, poseAtMs_ + step_ * kStepMs};
    (ahead_.empty() ? heldTo_ : ahead_.back().heldTo) = here;
  }
  // In pieces that end at the same cells for everyone; what is near does not wait for its end.
  const std::size_t least = heldSteps * kStepMs > kSoonMs ? 0 : 1;
  while (!isAsking_ && ahead_.size() > least && !endsPiece(ahead_.back().cell))
    ahead_.pop_back();
  return !ahead_.empty();
}

std::vector<VertexId> WayAhead::next(HaveSet& have, std::size_t most) {
  std::vector<VertexId> ids;
  while (!ahead_.empty() && ids.size() < most) {
    ScheduleCursor cursor;
    const auto more = nextSplits(*ahead_.front().set, have, most - ids.size(), cursor);
    ids.insert(ids.end(), more.begin(), more.end());
    if (ids.size() == most) break;  // there may be more
    noteAllHeld(ahead_.front().cell);
    heldTo_ = ahead_.front().heldTo;
    ahead_.erase(ahead_.begin());
    // What the next cell needs besides.
    for (const VertexId v : more)
      have.add(v);
  }
  if (most == 0) ahead_.clear();
  return ids;
}

void WayAhead::noteAllHeld(ViewCell cell) {
  if (cell == kNoCell || isAllHeld(cell)) return;
  allHeld_[nextAllHeld_] = cell;
  nextAllHeld_ = (nextAllHeld_ + 1) % allHeld_.size();
}

bool WayAhead::isAllHeld(ViewCell cell) const {
  return cell != kNoCell && std::ranges::find(allHeld_, cell) != allHeld_.end();
}

}  // namespace limn
