// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/catalogue.h"
#include "server/session/channel.h"
#include "server/session/grant.h"
#include "server/session/peer.h"
#include "server/session/view_cells.h"
#include "server/session/window.h"

#include "protocol/messages.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// What all sessions of a server share. Outlives them.
struct SessionShared {
  ModelSource& models;
  ViewCells& cells;
  SessionOptions options;
  std::string serverName = "limn-server";
  /// Splits that are coded only to be prefetched, of all clients.
  RateLimit prefetch{options.prefetchSplitsPerSecond, options.prefetchSplitsPerSecond / 50.0};
  // Counted by sessions.
  std::uint64_t poses = 0;
  std::uint64_t posesReplaced = 0;  // by a newer one before it was their turn
};

/// One connection, from Hello to close: takes in a client's messages, says what goes out next. All
/// that is kept for a client is here: a bit a vertex of each model it has open, a pose, a window.
/// Knows no sockets and no clock. Loop thread only.
class Session {
 public:
  enum class Close : std::uint8_t { kProtocolError, kGoingAway };

  /// grant: what the client may see; nullptr: everything.
  Session(
      SessionShared& shared,
      Peer& peer,
      std::int64_t nowMs,
      std::shared_ptr<const Grant> grant = nullptr);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// One message of the client. Answers come through nextMessage().
  void receive(protocol::Bytes message, std::int64_t nowMs);
  /// To be called about once a second, and soon after dueMs(); where that is in the past also after
  /// finished background work.
  void update(std::int64_t nowMs);

  /// When there may next be something to do though nothing comes from the client: its pose is at
  /// rest then; in the past: it waits for background work. nullopt: no such time. Changes with
  /// every other call.
  [[nodiscard]] std::optional<std::int64_t> dueMs() const;

  /// The next message to write, if there is one now. Messages are made here, not before, so they
  /// are for the newest pose.
  [[nodiscard]] std::optional<OutMessage> nextMessage(std::int64_t nowMs);
  /// Tells the client to move on; the connection is to be closed after the last message.
  void drain(std::uint32_t retryAfterMs);

  /// Why to close, once nextMessage() has nothing left.
  [[nodiscard]] std::optional<Close> close() const { return close_; }

  [[nodiscard]] bool greeted() const { return greeted_; }

  [[nodiscard]] std::int64_t bornMs() const { return bornMs_; }

  [[nodiscard]] std::uint64_t payloadBytes() const { return window_.sentBytes(); }

  /// See Window.
  [[nodiscard]] std::optional<std::int64_t> waitingSinceMs() const {
    return window_.waitingSinceMs();
  }

  /// Why it is to be closed, in a line; empty without a reason.
  [[nodiscard]] const std::string& closeReason() const { return closeReason_; }

  /// Ends the connection with an Error of code kLimit.
  void refuseForLimit(const std::string& why);

  [[nodiscard]] std::size_t channelCount() const { return channels_.size(); }

  /// Memory held for this client, shared target sets and models excluded.
  [[nodiscard]] std::size_t bytes() const;

 private:
  void handle(const protocol::Hello& hello);

  void handle(const protocol::GetCatalogue&) { catalogueWanted_ = true; }

  void handle(const protocol::Open& open);
  void handle(const protocol::HaveSet& piece);
  void handle(const protocol::Pose& pose);
  void handle(const protocol::Acknowledge& acknowledge);
  void handle(const protocol::Drop& drop);
  void handle(const protocol::GetHull& request);
  void handle(const protocol::GetMap& request);
  void handle(const protocol::GetContour& request);
  void answer(const Result<void>& taken, std::uint8_t channel);

  template <class Other>
  void handle(const Other&) {}  // decodeMessage() lets no server messages through

  [[nodiscard]] Channel* find(std::uint8_t id);
  [[nodiscard]] std::optional<OutMessage> nextPayload();
  bool lookAhead();
  /// Makes held poses count whose turn it is. True when there was one.
  bool takePoses();
  /// Queues an Error; channel −1 ends the connection, others the channel.
  void refuse(protocol::WireError code, std::int16_t channel, const std::string& why);
  void closeChannel(std::uint8_t id);
  void closeChannels();

  /// Lets others have of the prefetching what this channel was given and has no use for.
  void giveBack(Channel& channel) { shared_.prefetch.give(channel.takeSpared()); }

  /// Gives a loading channel its model if it has arrived. False when the channel is gone.
  bool tryLoad(Channel& channel);

  [[nodiscard]] bool mayOpen(std::string_view model) const {
    return grant_ == nullptr || grant_->allows(model);
  }

  SessionShared& shared_;
  Peer& peer_;
  std::shared_ptr<const Grant> grant_;
  std::int64_t bornMs_;
  std::int64_t nowMs_;
  bool greeted_ = false;
  bool welcomeWanted_ = false;
  bool catalogueWanted_ = false;
  std::deque<std::vector<std::uint8_t>> refusals_;
  std::optional<Close> close_;
  std::string closeReason_;
  Window window_;
  std::vector<std::unique_ptr<Channel>> channels_;
};

}  // namespace limn
