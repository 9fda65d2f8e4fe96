// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/have_set.h"
#include "server/session/model.h"
#include "server/session/motion.h"
#include "server/session/target_set.h"
#include "server/session/view_cell.h"
#include "server/session/view_cells.h"

#include "protocol/messages.h"

#include "shared/core/ids.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace limn {

/// Where a channel's camera is going, which cells lie on its way, and which of them the client
/// lacks something of (README.md, "Ahead"). Loop thread only.
class WayAhead {
 public:
  /// forMs: how far the motion is followed; 0: not at all.
  explicit WayAhead(std::int64_t forMs) : forMs_(forMs) { allHeld_.fill(kNoCell); }

  /// A new pose: what was found of the old way is looked for again.
  void add(const protocol::Pose& pose, std::int64_t nowMs);

  /// Something that was held no longer is.
  void forgetWhatIsHeld();

  /// Chooses cells on the way from the newest pose, unless there are some already. target: the cell
  /// whose set is being sent, which is no news. True when there is something to send.
  bool look(const std::shared_ptr<const Model>& model, ViewCells& cells, ViewCell target);

  void stopAsking() { isAsking_ = false; }

  /// Whether the next cell on the way is not there yet.
  [[nodiscard]] bool isAsking() const { return isAsking_; }

  /// Whether nothing chosen may miss.
  [[nodiscard]] bool isEmpty() const { return ahead_.empty(); }

  /// The next splits that are missing on the way, at most so many; those of cells that are passed
  /// over are added to `have`. Not sorted.
  [[nodiscard]] std::vector<VertexId> next(HaveSet& have, std::size_t most);

  /// Nothing is missing of a cell: those on the way are met again with every pose.
  void noteAllHeld(ViewCell cell);
  [[nodiscard]] bool isAllHeld(ViewCell cell) const;

 private:
  struct WayPoint {
    ViewCell cell = kNoCell;
    std::int64_t atMs = 0;  // when the camera will be there
  };

  struct Ahead {
    ViewCell cell = kNoCell;
    std::shared_ptr<const TargetSet> set;
    WayPoint heldTo;  // nothing else is missing up to there
  };

  [[nodiscard]] ViewCell cellIn(std::int64_t aheadMs, const Model& model) const;

  std::int64_t forMs_;
  Motion motion_;
  std::int64_t poseAtMs_ = 0;
  std::vector<Ahead> ahead_;     // cells on the way, nearest first, of which something may miss
  bool isAsking_ = false;        // the next cell on the way is not there yet
  std::int64_t step_ = -1;       // how far along the pose's way that is; -1: not looked at
  WayPoint heldTo_;              // nothing is missing on the way up to there
  bool isHeld_ = false;          // or on all of it that was to be sent when it was looked at
  std::int64_t lookedAtMs_ = 0;  // pose of that time
  std::array<ViewCell, 8> allHeld_{};  // the latest few, a ring
  std::size_t nextAllHeld_ = 0;
};

}  // namespace limn
