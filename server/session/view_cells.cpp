// SPDX-License-Identifier: Apache-2.0
#include "server/session/view_cells.h"

#include "server/session/contour_search.h"
#include "server/session/exact_set.h"

#include "shared/codec/contour_codec.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <utility>

namespace limn {
namespace {

TargetSet everythingOf(const SplitForest& forest) {
  return targetSetOf(forest, std::vector<std::uint8_t>(forest.splitCount(), 0), 1);
}

TargetSet exactSetOf(const Model& model, const protocol::Pose& pose) {
  const FullMesh* full = model.fullMesh();
  return full != nullptr ? selectExact(*full, viewOfPose(pose, model.forest().grid))
                         : everythingOf(model.forest());
}

TargetSet boundedSetOf(const Model& model, const protocol::Pose& pose) {
  return selectForView(model.forest(), viewOfPose(pose, model.forest().grid), model.smoothCones());
}

/// isUnwanted: as ContourSearch::run(); then the set says nothing.
TargetSet searchedSetOf(
    const Model& model,
    const protocol::Pose& pose,
    const HaveSet& have,
    const std::function<bool()>& isUnwanted) {
  const FullMesh* full = model.fullMesh();
  if (full == nullptr) return boundedSetOf(model, pose);
  ContourSearch search(*full, contourViewOf(pose, model.forest().grid), have.words());
  if (search.run(isUnwanted) || isUnwanted()) return search.target();
  // It found no end within its rounds: what it found, and what bounds say.
  TargetSet set = search.target();
  const TargetSet bounded = boundedSetOf(model, pose);
  for (std::size_t i = 0; i < bounded.all().size(); ++i)
    set.classes[0][i] |= bounded.all()[i];
  return set;
}

std::vector<std::uint8_t> contourMessageOf(
    const Model& model,
    const protocol::GetContour& request) {
  const ContourExtractor* contours = model.contours(
      request.silhouette == protocol::Silhouette::kSmooth ? SilhouetteKind::kSmooth
                                                          : SilhouetteKind::kEdges);
  if (contours == nullptr) return {};
  SilhouetteView view;
  view.eye = model.forest().grid.fromModel(request.eye);
  view.forward = glm::normalize(request.forward);
  view.orthographic = request.orthographic;
  const std::vector<std::uint8_t> lines = encodeContour(contours->extract(view));
  return protocol::encodeMessage(protocol::Contour{request.channel, request.id, lines});
}

}  // namespace

std::size_t ViewCells::KeyHash::operator()(const Key& key) const {
  std::uint64_t seed = 0;
  std::memcpy(&seed, key.asset.data(), sizeof(seed));
  std::uint64_t mixed = (seed ^ key.cell) * 0x9E3779B97F4A7C15ULL;
  return mixed ^ (mixed >> 29);
}

ViewCells::Ticket
ViewCells::cell(const std::shared_ptr<const Model>& model, ViewCell cell, TaskUrgency urgency) {
  const Key key{model->id(), cell};
  if (const auto found = byKey_.find(key); found != byKey_.end()) {
    entries_.splice(entries_.begin(), entries_, found->second);
    ++hits_;
    return found->second->job;
  }
  if (pendingCells_ >= options_.maxPending) return nullptr;
  const auto job = std::make_shared<Job>();
  entries_.push_front({key, job});
  byKey_.emplace(key, entries_.begin());
  ++pendingCells_;
  const auto result = std::make_shared<std::shared_ptr<const TargetSet>>();
  tasks_.submit(
      urgency,
      [model, cell, result] {
        const View view = viewOfCell(cell, model->info());
        *result = std::make_shared<const TargetSet>(
            selectForView(model->forest(), view, model->smoothCones()));
      },
      [this, job, result] {
        job->set = std::move(*result);
        bytes_ += job->set->bytes();
        ++computed_;
        --pendingCells_;
        evict();
      });
  return job;
}

ViewCells::Ticket ViewCells::pose(
    const std::shared_ptr<const Model>& model,
    const protocol::Pose& pose,
    Need need,
    const HaveSet& have) {
  if (auto shared = sharedPose(*model, pose, need, have)) {
    ++hits_;
    return shared;
  }
  const bool search = need == Need::kSettled && pendingSearches_ < options_.maxSearches;
  if (need == Need::kSettled && !search) {
    const auto cell = restCellOf(pose, model->info());
    if (cell) return this->cell(model, *cell, TaskUrgency::kView);
  }
  const auto job = std::make_shared<Job>();
  const auto result = std::make_shared<std::shared_ptr<const TargetSet>>();
  const std::weak_ptr<Job> wanted = job;
  if (search) ++pendingSearches_;
  std::shared_ptr<PoseEntry> entry;
  // What bounds say is a makeshift: not for those who come later.
  if ((search || need == Need::kExact) && options_.keptPoses > 0) {
    entry = std::make_shared<PoseEntry>(PoseEntry{model->id(), pose, need, have, job, nullptr});
    poses_.push_front(entry);
    if (poses_.size() > options_.keptPoses) poses_.pop_back();
  }
  tasks_.submit(
      search ? TaskUrgency::kSearch : TaskUrgency::kView,
      [model, pose, need, search, have, wanted, result] {
        if (wanted.expired()) return;
        TargetSet set = need == Need::kExact ? exactSetOf(*model, pose)
                        : search
                            ? searchedSetOf(*model, pose, have, [&] { return wanted.expired(); })
                            : boundedSetOf(*model, pose);
        if (wanted.expired()) return;
        *result = std::make_shared<const TargetSet>(std::move(set));
      },
      [this, search, wanted, result, entry] {
        if (search) --pendingSearches_;
        if (*result) ++computed_;
        if (entry) entry->set = *result;
        if (const auto still = wanted.lock()) still->set = std::move(*result);
      });
  return job;
}

bool ViewCells::mayAsk(const Model& model, const protocol::Pose& pose) const {
  if (pendingSearches_ < options_.maxSearches || pendingCells_ < options_.maxPending) return true;
  const auto cell = restCellOf(pose, model.info());
  if (!cell || byKey_.contains(Key{model.id(), *cell})) return true;
  return isSearched(model, pose);
}

bool ViewCells::mayJump(const Model& model, const protocol::Pose& pose, std::int64_t nowMs) {
  return isSearched(model, pose) || jumps_.take(nowMs);
}

/// Whether somebody looks from there, or did not long ago.
bool ViewCells::isSearched(const Model& model, const protocol::Pose& pose) const {
  return std::ranges::any_of(poses_, [&](const auto& entry) {
    return entry->need == Need::kSettled && sameView(entry->pose, pose) &&
           entry->asset == model.id();
  });
}

ViewCells::Ticket ViewCells::sharedPose(
    const Model& model,
    const protocol::Pose& pose,
    Need need,
    const HaveSet& have) {
  const auto found = std::ranges::find_if(poses_, [&](const auto& entry) {
    return entry->need == need && entry->have.count() == have.count() &&
           sameView(entry->pose, pose) && entry->asset == model.id() &&
           std::ranges::equal(entry->have.words(), have.words());
  });
  if (found == poses_.end()) return nullptr;
  const std::shared_ptr<PoseEntry> entry = *found;
  poses_.erase(found);
  Ticket ticket = entry->job.lock();
  if (entry->set) ticket = std::make_shared<const Job>(Job{entry->set});
  if (ticket) poses_.push_front(entry);
  return ticket;
}

ViewCells::ContourTicket ViewCells::contour(
    const std::shared_ptr<const Model>& model,
    const protocol::GetContour& request) {
  const auto job = std::make_shared<ContourJob>();
  const std::weak_ptr<ContourJob> wanted = job;
  const auto result = std::make_shared<std::vector<std::uint8_t>>();
  tasks_.submit(
      TaskUrgency::kView,
      [model, request, wanted, result] {
        if (!wanted.expired()) *result = contourMessageOf(*model, request);
      },
      [wanted, result] {
        const auto still = wanted.lock();
        if (!still) return;
        still->message = std::move(*result);
        still->done = true;
      });
  return job;
}

void ViewCells::evict() {
  for (auto last = entries_.end(); bytes_ > options_.cacheBytes && last != entries_.begin();) {
    --last;
    if (!last->job->set) continue;  // still on its way
    bytes_ -= last->job->set->bytes();
    byKey_.erase(last->key);
    last = entries_.erase(last);
  }
}

}  // namespace limn
