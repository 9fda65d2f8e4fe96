// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/catalogue.h"
#include "server/session/contour_requests.h"
#include "server/session/have_set.h"
#include "server/session/hull_stream.h"
#include "server/session/model.h"
#include "server/session/model_start.h"
#include "server/session/rate_limit.h"
#include "server/session/resumed_set.h"
#include "server/session/scheduler.h"
#include "server/session/view_cells.h"
#include "server/session/way_ahead.h"
#include "server/session/window.h"

#include "protocol/messages.h"

#include "shared/core/rng.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace limn {

struct SessionOptions {
  std::uint64_t windowBytes = 256 * 1024;   // payload on its way to a client
  std::size_t packetBytes = 8 * 1024;       // aim of a Packet
  std::size_t seedPieceBytes = 4 * 1024;    // of one Seeds message
  std::size_t maxChannels = 16;             // models open at once on a connection
  std::int64_t restMs = 250;                // a pose this old is resting
  std::int64_t prefetchAfterMs = 1000;      // a pose this old gets everything; < 0: never
  double prefetchSplitsPerSecond = 5e5;     // of all clients, unless others were sent the same
  std::int64_t aheadMs = 1500;              // how far a motion is followed ahead; 0: not at all
  double posesPerSecond = 60.0;             // of a channel; of more than that the newest count
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

/// How badly the picture lacks what a channel would send next; most urgent first.
enum class Urgency : std::uint8_t {
  kPicture,    // the start of a model in view
  kHull,       // what was asked for of the hulls
  kContour,    // the exact contour that was asked for
  kNeededAt8,  // what the pose needs, by TargetClass
  kNeededAt4,
  kNeededAt2,
  kNeededAt1,
  kOutOfView,  // the start of a model out of view
  kSeeds,
  kAhead,       // what the camera's motion will need
  kEverything,  // the rest, while nothing moves
  kNothing,
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
  /// Takes a pose; more than posesPerSecond are held back, and of those the newest is kept. False
  /// when another one was lost for it.
  bool pose(const protocol::Pose& pose, ViewCells& cells, std::int64_t nowMs);
  /// Takes the pose that is held back if it is its turn. True when it did.
  bool takeHeldPose(ViewCells& cells, std::int64_t nowMs);
  /// Takes it whatever the rate: what follows builds on it.
  void takeHeldPoseNow(ViewCells& cells, std::int64_t nowMs);
  /// Drops what can go and queues the answer. Errors: kProtocol (not an id set of splits held, or
  /// the last Drop's answer is still to be sent).
  [[nodiscard]] Result<void> drop(protocol::Bytes ids);

  /// Errors: kNotFound (no hull), kProtocol (before ModelInfo, or more held than there is).
  [[nodiscard]] Result<void> getHull(const protocol::GetHull& request);

  /// As getHull().
  [[nodiscard]] Result<void> getMap(const protocol::GetMap& request);

  /// The newest request counts; one is worked on at a time. Errors: kProtocol (before ModelInfo, or
  /// an id that does not grow).
  [[nodiscard]] Result<void> getContour(const protocol::GetContour& request, ViewCells& cells);

  /// Why the channel must be closed: a contour that cannot be sent.
  [[nodiscard]] bool contourFailed() const { return contours_.hasFailed(); }

  /// Takes in finished target sets and the passing of time. True when there may be more to send.
  [[nodiscard]] bool update(ViewCells& cells, std::int64_t nowMs);

  /// When update() may next have something to do though nothing comes from the client; in the past:
  /// as soon as any background work is done. nullopt: not before the next pose.
  [[nodiscard]] std::optional<std::int64_t> dueMs() const;

  /// Whether there is time for what the pose does not need.
  [[nodiscard]] bool mayPrefetch(std::int64_t nowMs) const;
  /// Sends that from now on, until the next pose. Returns how many splits it is.
  [[nodiscard]] double prefetch();

  /// How many of them, since the last call, turned out not to be coded: others were sent the same,
  /// or something else came first.
  [[nodiscard]] double takeSpared() { return static_cast<double>(std::exchange(spared_, 0)); }

  /// Sends nothing more than what is needed.
  void endPrefetch();

  /// Chooses a cell on the camera's way once everything before it is sent. True when it did: there
  /// may be more to send.
  [[nodiscard]] bool lookAhead(ViewCells& cells, std::int64_t nowMs);

  /// The next message that no window holds back (descriptions, answers), if there is one.
  [[nodiscard]] std::optional<OutMessage> nextControl();
  /// Of the payload that is to come next. An upper bound: nextPayload() may find there is nothing
  /// that urgent, and lowers it then.
  [[nodiscard]] Urgency urgency() const;
  /// The next payload within the window. None with urgency() unchanged: the window is full.
  [[nodiscard]] std::optional<OutMessage> nextPayload(const Window& window);

  /// Payload bytes given to this channel, for fairness.
  [[nodiscard]] std::uint64_t servedBytes() const { return servedBytes_; }

  void addServed(std::uint64_t bytes) { servedBytes_ += bytes; }

  [[nodiscard]] const HaveSet& have() const { return have_; }

  /// Memory of this channel, shared target sets excluded.
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(*this) + have_.bytes() + request_.model.capacity() +
           (droppedAnswer_ ? droppedAnswer_->capacity() : 0);
  }

 private:
  /// Of a client's room: what is only prefetched leaves the last one free.
  static constexpr std::uint32_t kAheadQuarters = 3;

  /// What is being sent once the level blocks are through.
  enum class Plan : std::uint8_t {
    kNothing,      // no pose yet, or its target set is on its way and there is none to go on with
    kCell,         // the cell of this or an earlier pose
    kPoseSettled,  // the current pose's own set
    kPoseExact,
    kEverything,
  };

  void take(const protocol::Pose& pose, ViewCells& cells, std::int64_t nowMs);
  [[nodiscard]] bool resting(std::int64_t nowMs) const;
  [[nodiscard]] bool planIsFinal() const;
  void adopt(Plan plan, std::shared_ptr<const TargetSet> target, ViewCell cell = kNoCell);
  bool adoptPending();
  void noteStay(ViewCells& cells, std::int64_t nowMs);
  bool steer(ViewCells& cells, std::int64_t nowMs);
  [[nodiscard]] bool isInView() const;
  /// Splits that the client still has room for, of `share` quarters of its limit.
  [[nodiscard]] std::uint32_t roomFor(std::uint32_t share) const;
  [[nodiscard]] std::uint32_t missing() const;
  [[nodiscard]] Result<void> finishResume();
  [[nodiscard]] std::optional<OutMessage> nextStart(const Window& window);
  [[nodiscard]] std::optional<OutMessage> nextHull(const Window& window);
  [[nodiscard]] std::optional<OutMessage> nextContour(const Window& window);
  [[nodiscard]] std::optional<OutMessage> nextNeeded(const Window& window);
  [[nodiscard]] std::optional<OutMessage> nextAhead(const Window& window);
  [[nodiscard]] std::optional<OutMessage> nextSeeds(const Window& window);
  /// Ids (sorted, the first that are missing) cut off where a run begins of which the client has
  /// nothing: that one is smaller sent as it is.
  [[nodiscard]] std::vector<VertexId> beforeUntouchedRun(std::vector<VertexId> ids) const;
  /// While everything is sent: the run that the client lacks whole and first, if there is one.
  [[nodiscard]] const Model::Run* nextRun() const;
  [[nodiscard]] OutMessage packetOf(const std::vector<VertexId>& ids);
  [[nodiscard]] OutMessage packetOf(const Model::Run& run);
  [[nodiscard]] OutMessage packetOf(protocol::Bytes splits, protocol::Bytes attributes) const;
  [[nodiscard]] std::size_t splitsAPacket() const;
  [[nodiscard]] std::optional<OutMessage> nextSettled();
  [[nodiscard]] std::vector<VertexId> choose(std::size_t maxSplits);
  [[nodiscard]] OutMessage sharedMessage(protocol::Bytes message) const;

  Request request_;
  SessionOptions options_;
  std::shared_ptr<const Model> model_;
  HaveSet have_;
  Rng rng_;

  ResumedSet resumed_;
  bool infoSent_ = false;
  ModelStart start_;
  HullStream hulls_;
  ContourRequests contours_;
  WayAhead way_;

  // The pose and what it needs.
  std::optional<protocol::Pose> heldPose_;  // until it is its turn
  RateLimit poseRate_;
  std::optional<protocol::Pose> pose_;
  std::int64_t poseAtMs_ = 0;
  ViewCell poseCell_ = kNoCell;  // once it was looked for
  bool jumped_ = false;          // the pose came after a rest: its own set at once, no cell
  bool countsAsJump_ = false;    // of those that so many may
  bool poseHasOwnSet_ = false;   // pending_ or target_ is the current pose's own
  Plan plan_ = Plan::kNothing;
  std::shared_ptr<const TargetSet> target_;
  ViewCell targetCell_ = kNoCell;  // whose set that is
  ViewCells::Ticket pending_;
  Plan pendingPlan_ = Plan::kNothing;
  ViewCell pendingCell_ = kNoCell;
  bool cellRefused_ = false;  // too many are on their way: to be asked again
  ScheduleCursor cursor_;
  bool exhausted_ = false;  // nothing of plan_ is missing
  bool satisfied_ = false;  // nothing that the pose's goal needs is missing
  bool full_ = false;       // something that the pose needs is missing, and there is no room
  bool fullSent_ = false;
  bool prefetching_ = false;
  std::size_t spared_ = 0;     // splits of prefetch() that are not coded
  bool settledSent_ = false;   // for this pose and goal
  bool completeSent_ = false;  // for this pose
  std::optional<std::vector<std::uint8_t>> droppedAnswer_;
  double bytesPerSplit_ = 4.0;  // running estimate
  std::uint64_t servedBytes_ = 0;
};

}  // namespace limn
