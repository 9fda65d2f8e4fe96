// SPDX-License-Identifier: Apache-2.0
//
// Based on: H. Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997 (cells of
// view space share what they need); M. Mohr et al. (2013), viewpoints on a sphere around the model.
#include "server/session/view_cells.h"

#include "server/session/contour_search.h"
#include "server/session/exact_set.h"

#include "shared/codec/contour_codec.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace limn {
namespace {

constexpr int kDirectionSteps = 16;  // along an edge of the cube: 90° / 16
constexpr double kDistanceStepsPerOctave = 4.0;
constexpr double kAngleStepsPerOctave = 2.0;
constexpr double kConeSteps = 16.0;  // of half-angles, from 0 to π

/// Index of a direction on a cube map of kDirectionSteps² cells a side, and the middle of that
/// cell.
struct DirectionCell {
  std::uint32_t index = 0;
  glm::dvec3 middle{0.0, 0.0, 1.0};
};

DirectionCell directionCellOf(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const bool negative = direction[axis] < 0.0;
  // Steps equal in angle, not in tangent, so that cells are about the same size.
  const auto step = [&](int other) {
    const double angle = std::atan(direction[other] / size[axis]);  // −π/4 … π/4
    const double t = (angle / (std::atan(1.0) * 2.0) + 0.5) * kDirectionSteps;
    return std::clamp(static_cast<int>(std::floor(t)), 0, kDirectionSteps - 1);
  };
  const auto middle = [](int i) {
    return std::tan(((i + 0.5) / kDirectionSteps - 0.5) * std::atan(1.0) * 2.0);
  };
  const int a = step((axis + 1) % 3);
  const int b = step((axis + 2) % 3);
  DirectionCell cell;
  const int side = axis * 2 + (negative ? 1 : 0);
  cell.index = static_cast<std::uint32_t>((side * kDirectionSteps + a) * kDirectionSteps + b);
  cell.middle[axis] = negative ? -1.0 : 1.0;
  cell.middle[(axis + 1) % 3] = middle(a);
  cell.middle[(axis + 2) % 3] = middle(b);
  cell.middle = glm::normalize(cell.middle);
  return cell;
}

/// log2 in steps, as an unsigned number below 2^10.
std::uint32_t logStep(double value, double stepsPerOctave) {
  const double step = std::floor(std::log2(std::max(value, 1e-30)) * stepsPerOctave);
  return static_cast<std::uint32_t>(std::clamp(step + 512.0, 0.0, 1023.0));
}

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

TargetSet searchedSetOf(const Model& model, const protocol::Pose& pose, const HaveSet& have) {
  const FullMesh* full = model.fullMesh();
  if (full == nullptr) return boundedSetOf(model, pose);
  ContourSearch search(*full, contourViewOf(pose, model.forest().grid), have.words());
  if (search.run()) return search.target();
  // It found no end within its rounds: what it found, and what bounds say.
  TargetSet set = search.target();
  for (const auto& words : boundedSetOf(model, pose).classes) {
    for (std::size_t i = 0; i < words.size(); ++i)
      set.classes[0][i] |= words[i];
  }
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

ViewCell viewCellOf(const protocol::Pose& pose, const protocol::ModelInfo& model) {
  const double radius = std::max(model.radius, model.gridStep);
  const glm::dvec3 center = (model.center - model.gridOrigin) / model.gridStep;
  const glm::dvec3 fromCenter = pose.eye - model.center;
  const double distance = std::max(glm::length(fromCenter), 1e-9 * radius);
  const glm::dvec3 forward = glm::normalize(pose.forward);
  const bool orthographic = pose.orthoHeight > 0.0;
  const DirectionCell direction = directionCellOf(
      orthographic                    ? -forward
      : glm::length(fromCenter) > 0.0 ? fromCenter
                                      : -forward);

  ViewCell cell;
  View& view = cell.view;
  view.silhouette = pose.silhouette;
  view.orthographic = orthographic;
  view.errorPx = 1.0;
  // The error bound as a length a unit of distance (an angle), or as a length.
  const double tanY = std::tan(static_cast<double>(pose.fovY) / 2.0);
  const double bound = orthographic ? pose.errorPx * pose.orthoHeight / pose.height / radius
                                    : pose.errorPx * 2.0 * tanY / pose.height;
  const std::uint32_t boundStep = logStep(bound, kAngleStepsPerOctave);
  const double roundedBound = std::exp2((boundStep - 512.0) / kAngleStepsPerOctave);
  const std::uint32_t distanceStep =
      orthographic ? 0 : logStep(distance / radius, kDistanceStepsPerOctave);
  const double middleDistance =
      orthographic ? 4.0 : std::exp2((distanceStep - 512.0 + 0.5) / kDistanceStepsPerOctave);
  const double gridRadius = radius / model.gridStep;
  view.pixelsPerUnit = orthographic ? 1.0 / (roundedBound * gridRadius) : 1.0 / roundedBound;
  view.eye = center + direction.middle * middleDistance * gridRadius;
  view.forward = -direction.middle;

  // The frustum as a cone, if the model sticks out of it. An orthographic cell takes all of it:
  // what is seen is the resting pose's own set.
  std::uint32_t coneStep = 0;
  std::uint32_t forwardIndex = 0;
  if (!orthographic) {
    const double aspect = static_cast<double>(pose.width) / pose.height;
    const double narrow = std::atan(tanY * std::min(1.0, aspect));
    const double wide = std::atan(tanY * std::hypot(1.0, aspect));
    const double toCenter =
        std::acos(std::clamp(glm::dot(-fromCenter / distance, forward), -1.0, 1.0));
    const bool inside = distance <= radius;
    if (inside || toCenter + std::asin(radius / distance) > narrow) {
      const DirectionCell look = directionCellOf(forward);
      forwardIndex = look.index + 1;
      // Two steps of slack: half a cell of looking, half a cell of standing, rounded up.
      coneStep = static_cast<std::uint32_t>(std::ceil(wide / std::acos(-1.0) * kConeSteps)) + 1;
      view.clip = View::Clip::kCone;
      view.forward = look.middle;
      view.coneHalfAngle = std::min(coneStep / kConeSteps, 1.0) * std::acos(-1.0);
    }
  }
  cell.key = direction.index;                           // 11 bits
  cell.key = cell.key << 10 | distanceStep;             // 10
  cell.key = cell.key << 10 | boundStep;                // 10
  cell.key = cell.key << 11 | forwardIndex;             // 11
  cell.key = cell.key << 5 | coneStep;                  // 5
  cell.key = cell.key << 1 | (orthographic ? 1U : 0U);  // 1
  cell.key = cell.key << 2 | static_cast<std::uint32_t>(pose.silhouette);
  return cell;
}

std::size_t ViewCells::KeyHash::operator()(const Key& key) const {
  std::uint64_t seed = 0;
  std::memcpy(&seed, key.asset.data(), sizeof(seed));
  std::uint64_t mixed = (seed ^ key.cell) * 0x9E3779B97F4A7C15ULL;
  return mixed ^ (mixed >> 29);
}

ViewCells::Ticket ViewCells::cell(
    const std::shared_ptr<const Model>& model,
    const protocol::Pose& pose) {
  ViewCell cell = viewCellOf(pose, model->info());
  const Key key{model->id(), cell.key};
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
      [model, view = cell.view, result] {
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
  const auto job = std::make_shared<Job>();
  const auto result = std::make_shared<std::shared_ptr<const TargetSet>>();
  const std::weak_ptr<Job> wanted = job;
  const bool search = need == Need::kSettled && pendingSearches_ < options_.maxSearches;
  if (search) ++pendingSearches_;
  std::shared_ptr<PoseEntry> entry;
  // What bounds say is a makeshift: not for those who come later.
  if ((search || need == Need::kExact) && options_.keptPoses > 0) {
    entry = std::make_shared<PoseEntry>(PoseEntry{model->id(), pose, need, have, job, nullptr});
    poses_.push_front(entry);
    if (poses_.size() > options_.keptPoses) poses_.pop_back();
  }
  tasks_.submit(
      [model, pose, need, search, have, wanted, result] {
        if (wanted.expired()) return;
        TargetSet set = need == Need::kExact ? exactSetOf(*model, pose)
                        : search             ? searchedSetOf(*model, pose, have)
                                             : boundedSetOf(*model, pose);
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
