// SPDX-License-Identifier: Apache-2.0
#include "client/core/cone_keeper.h"

#include <chrono>
#include <utility>

namespace limn {

void ConeKeeper::Fitted::refit(
    const std::shared_ptr<const MeshSnapshot>& to,
    const SilhouetteField& field) {
  if (snapshot == to) return;
  // A detector may still be looking at them.
  if (cones.use_count() > 1) cones = std::make_shared<ConeForest>(*cones);
  cones->refit(snapshot->mesh.mesh(), snapshot->mesh.positions(), field);
  snapshot = to;
}

std::shared_ptr<const ConeForest> ConeKeeper::conesOf(
    const std::shared_ptr<const MeshSnapshot>& snapshot,
    const SilhouetteField& field) {
  const bool isSameModel =
      current_.snapshot != nullptr && current_.snapshot->model.asset == snapshot->model.asset;
  if (!isSameModel) {
    rebuilt_ = {};  // waits for what nobody wants any more
    current_ = {std::make_shared<ConeForest>(field), snapshot};
    return current_.cones;
  }
  current_.refit(snapshot, field);
  takeRebuilt(snapshot, field);
  if (current_.cones->looseness() > options_.rebuildAbove && !rebuilt_.valid()) {
    rebuilt_ = std::async(std::launch::async, [snapshot, kind = kind_] {
      const SilhouetteField own(snapshot->mesh.mesh(), snapshot->mesh.positions(), kind);
      return Fitted{std::make_shared<ConeForest>(own), snapshot};
    });
  }
  return current_.cones;
}

// Takes what was built meanwhile, if it is done and better than what is there.
void ConeKeeper::takeRebuilt(
    const std::shared_ptr<const MeshSnapshot>& snapshot,
    const SilhouetteField& field) {
  if (!rebuilt_.valid() ||
      rebuilt_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;
  }
  Fitted fresh = rebuilt_.get();
  fresh.refit(snapshot, field);
  if (fresh.cones->looseness() >= current_.cones->looseness()) return;
  current_ = std::move(fresh);
  ++replacements_;
}

void ConeKeeper::wait() const {
  if (rebuilt_.valid()) rebuilt_.wait();
}

}  // namespace limn
