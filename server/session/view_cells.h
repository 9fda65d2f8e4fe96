// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/have_set.h"
#include "server/session/model.h"
#include "server/session/rate_limit.h"
#include "server/session/target_set.h"
#include "server/session/task_runner.h"
#include "server/session/view_cell.h"

#include "protocol/messages.h"

#include "shared/core/sha256.h"

#include <cstdint>
#include <list>
#include <memory>
#include <unordered_map>
#include <vector>

namespace limn {

struct ViewCellOptions {
  std::size_t cacheBytes = std::size_t{256} << 20;
  std::size_t maxPending = 64;  // cells beyond that are not started
  std::size_t maxSearches = 4;  // contour searches at a time; beyond, bounds of splits decide
  std::size_t keptPoses = 8;    // sets of single poses that are kept for others
  // Poses after a rest that get their own set before they have rested themselves, and never do; so
  // many at once.
  double jumpsPerSecond = 0.25;
  double jumpsAtOnce = 4.0;
};

/// Computes on workers: target sets of cells, cached and shared by all sessions, and of single
/// poses; exact contours. Loop thread only; what it hands out is constant.
class ViewCells {
 public:
  /// A target set on its way. `set` appears on the loop thread; dropping the ticket of a single
  /// pose cancels work that has not begun.
  struct Job {
    std::shared_ptr<const TargetSet> set;
  };

  using Ticket = std::shared_ptr<const Job>;
  enum class Need : std::uint8_t { kSettled, kExact };

  ViewCells(TaskRunner& tasks, const ViewCellOptions& options)
      : tasks_(tasks),
        options_(options),
        jumps_(options.jumpsPerSecond, options.jumpsAtOnce) {}

  /// The set of a cell. Null when too many others are on their way: ask again later.
  [[nodiscard]] Ticket cell(
      const std::shared_ptr<const Model>& model,
      ViewCell cell,
      TaskUrgency urgency = TaskUrgency::kMotion);

  /// What exactly this pose needs besides `have` (words as in HaveSet, closed, with the base). For
  /// kSettled nothing else may be added to `have` meanwhile: it is searched for on the mesh that
  /// the client will then have. Clients that hold the same and stand at the same place, a crowd
  /// that comes to a model's first view, share one set: it is computed once, and the last few are
  /// kept. Beyond maxSearches it is that of the pose's restCellOf(), a cell like those of cell().
  /// Null when too many of these are on their way: ask again later.
  [[nodiscard]] Ticket pose(
      const std::shared_ptr<const Model>& model,
      const protocol::Pose& pose,
      Need need,
      const HaveSet& have);

  /// Whether pose() has a ticket for kSettled now: found out without `have`, which takes long to
  /// make for many who wait.
  [[nodiscard]] bool mayAsk(const Model& model, const protocol::Pose& pose) const;

  /// Whether a pose that comes after a rest, a model's first for instance, may ask for its own set
  /// at once, as if it were going to stay: then it counts until that turns out to be so. A crowd
  /// that comes and goes on moving would keep the workers busy with sets that nobody wants in the
  /// end.
  [[nodiscard]] bool mayJump(const Model& model, const protocol::Pose& pose, std::int64_t nowMs);

  void giveJumpBack() { jumps_.give(1.0); }

  /// A Contour message on its way; as Job.
  struct ContourJob {
    bool done = false;
    std::vector<std::uint8_t> message;  // empty: the model's full mesh cannot be had
  };

  using ContourTicket = std::shared_ptr<const ContourJob>;

  /// The answer to a request, with its channel and id.
  [[nodiscard]] ContourTicket contour(
      const std::shared_ptr<const Model>& model,
      const protocol::GetContour& request);

  [[nodiscard]] std::size_t cachedBytes() const { return bytes_; }

  [[nodiscard]] std::uint64_t computed() const { return computed_; }

  [[nodiscard]] std::uint64_t hits() const { return hits_; }

 private:
  struct Key {
    Sha256Digest asset{};
    ViewCell cell = kNoCell;
    friend bool operator==(const Key&, const Key&) = default;
  };

  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };

  struct Entry {
    Key key;
    std::shared_ptr<Job> job;
  };

  /// What a single pose needs of a client that holds `have`.
  struct PoseEntry {
    Sha256Digest asset{};
    protocol::Pose pose;
    Need need = Need::kSettled;
    HaveSet have;
    std::weak_ptr<const Job> job;          // of the last who asked
    std::shared_ptr<const TargetSet> set;  // once computed
  };

  [[nodiscard]] bool isSearched(const Model& model, const protocol::Pose& pose) const;
  void evict();
  /// The set of an equal pose, there or on its way; null: nobody asked yet, or nobody wants it.
  [[nodiscard]] Ticket
  sharedPose(const Model& model, const protocol::Pose& pose, Need need, const HaveSet& have);

  TaskRunner& tasks_;
  ViewCellOptions options_;
  RateLimit jumps_;
  std::list<Entry> entries_;  // most recently used first
  std::unordered_map<Key, std::list<Entry>::iterator, KeyHash> byKey_;
  std::list<std::shared_ptr<PoseEntry>> poses_;  // most recently used first
  std::size_t bytes_ = 0;
  std::size_t pendingCells_ = 0;
  std::size_t pendingSearches_ = 0;
  std::uint64_t computed_ = 0;
  std::uint64_t hits_ = 0;
};

}  // namespace limn
