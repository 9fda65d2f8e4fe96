// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/catalogue.h"
#include "server/session/have_set.h"
#include "server/session/model.h"
#include "server/session/scheduler.h"
#include "server/session/view_cells.h"
#include "server/session/window.h"

#include "protocol/messages.h"

#include "shared/core/rng.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace limn {

struct SessionOptions {
  std::uint64_t windowBytes = 256 * 1024;   // payload on its way to a client
  std::size_t packetBytes = 8 * 1024;       // aim of a Packet
  std::size_t maxChannels = 16;             // models open at once on a connection
  std::int64_t restMs = 250;                // a pose this old is resting
  std::int64_t prefetchAfterMs = 1000;      // a pose this old gets everything; < 0: never
  std::optional<std::uint64_t> randomSeed;  // test mode: splits in random legal order
};

/// A message to send.
struct OutMessage {
  std::shared_ptr<const void> keepAlive;  // of `shared`
  protocol::Bytes shared;                 // used unless `owned` has something
  std::vector<std::uint8_t> owned;
  bool payload = false;  // counts against the window

  [[nodiscard]] protocol::Bytes bytes() const {
    return owned.empty() ? shared : protocol::Bytes(owned);
  }
};

/// One open model of a connection: what its client holds, where it looks from, what comes next.
/// Time is passed in. Loop thread only.
class Channel {
 public:
  struct Request {
    std::uint8_t id = 0;
    std::string model;
    bool resume = false;
  };

  Channel(Request request, std::uint32_t vertexCount, const SessionOptions& options);

  [[nodiscard]] std::uint8_t id() const { return request_.id; }

  [[nodiscard]] const std::string& modelName() const { return request_.model; }

  [[nodiscard]] bool loading() const { return model_ == nullptr; }

  /// Hands over the model once it is in memory. Errors: as haveSet(), when its pieces came before.
  [[nodiscard]] Result<void> setModel(std::shared_ptr<const Model> model);

  /// Errors: kCorrupt (another asset: stale), kProtocol (not closed, out of order, not expected).
  [[nodiscard]] Result<void> haveSet(const protocol::HaveSet& piece);
  void pose(const protocol::Pose& pose, ViewCells& cells, std::int64_t nowMs);
  /// Errors: kProtocol (not an id set of splits held).
  [[nodiscard]] Result<void> drop(protocol::Bytes ids);

  /// Takes in finished target sets and the passing of time. True when there may be more to send.
  [[nodiscard]] bool update(ViewCells& cells, std::int64_t nowMs);

  /// The next message within the window, if there is one.
  [[nodiscard]] std::optional<OutMessage> next(const Window& window);

  [[nodiscard]] const HaveSet& have() const { return have_; }

  /// Memory of this channel, shared target sets excluded.
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(*this) + have_.bytes() + request_.model.capacity();
  }

 private:
  /// What is being sent once the level blocks are through.
  enum class Plan : std::uint8_t {
    kNothing,      // no pose yet, or its target set is on its way and there is none to go on with
    kCell,         // the cell of this or an earlier pose
    kPoseSettled,  // the current pose's own set
    kPoseExact,
    kEverything,
  };

  [[nodiscard]] bool resting(std::int64_t nowMs) const;
  [[nodiscard]] bool planIsFinal() const;
  void adopt(Plan plan, std::shared_ptr<const TargetSet> target);
  bool steer(ViewCells& cells, std::int64_t nowMs);
  [[nodiscard]] Result<void> finishResume();
  [[nodiscard]] std::optional<OutMessage> nextStart(const Window& window);
  [[nodiscard]] std::optional<OutMessage> nextBlock(const Window& window);
  [[nodiscard]] std::optional<OutMessage> nextPacket(const Window& window);
  [[nodiscard]] std::optional<OutMessage> nextSettled();
  [[nodiscard]] std::vector<VertexId> choose(std::size_t maxSplits);
  [[nodiscard]] OutMessage sharedMessage(protocol::Bytes message) const;

  Request request_;
  SessionOptions options_;
  std::shared_ptr<const Model> model_;
  HaveSet have_;
  Rng rng_;

  // Resuming.
  std::optional<Sha256Digest> resumeAsset_;
  std::uint32_t resumeNext_ = 0;  // where the next piece must begin
  bool resumeBase_ = false;
  bool awaitingHaveSet_ = false;
  bool resumeEnded_ = false;

  // The start, the same for everyone.
  bool infoSent_ = false;
  bool baseSent_ = false;
  bool seedsSent_ = false;
  bool blocksDone_ = false;
  std::uint32_t nextBlock_ = 0;

  // The pose and what it needs.
  std::optional<protocol::Pose> pose_;
  std::int64_t poseAtMs_ = 0;
  bool jumped_ = false;         // the pose came after a rest: its own set at once, no cell
  bool poseHasOwnSet_ = false;  // pending_ or target_ is the current pose's own
  Plan plan_ = Plan::kNothing;
  std::shared_ptr<const TargetSet> target_;
  ViewCells::Ticket pending_;
  Plan pendingPlan_ = Plan::kNothing;
  ScheduleCursor cursor_;
  bool exhausted_ = false;  // nothing of plan_ is missing
  bool satisfied_ = false;  // nothing that the pose's goal needs is missing
  bool prefetching_ = false;
  bool settledSent_ = false;    // for this pose and goal
  bool completeSent_ = false;   // for this pose
  double bytesPerSplit_ = 4.0;  // running estimate
};

}  // namespace limn
