// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/messages.h"

#include "shared/core/camera.h"

#include <cstdint>
#include <optional>

namespace limn {

/// Where the user looks from and how well it should look.
struct ClientView {
  Camera camera;
  Viewport viewport;
  float errorPx = 1.0F;
  protocol::Silhouette silhouette = protocol::Silhouette::kSmooth;
  protocol::Goal goal = protocol::Goal::kSettled;
  /// Above 0: of so many faces an outer hull is wanted from now on, with its maps, of a model that
  /// has one.
  std::uint32_t hullFaces = 0;
};

/// The view as the wire carries it.
[[nodiscard]] protocol::Pose toPose(const ClientView& view, std::uint8_t channel, std::uint32_t id);

/// Decides which views become Pose messages: the newest one, no two alike, at most one every
/// kMinIntervalMs. Pure; time is an argument.
class PoseReporter {
 public:
  /// Below the 60 poses a second that a server takes from one client.
  static constexpr std::uint64_t kMinIntervalMs = 20;

  explicit PoseReporter(std::uint8_t channel) : channel_(channel) {}

  /// The newest view; replaces one that was not sent yet.
  void set(const ClientView& view);
  /// Makes the present view due again, for a new connection.
  void repeat();
  /// The pose to send now, if one is due.
  [[nodiscard]] std::optional<protocol::Pose> next(std::uint64_t nowMs);
  /// The newest view as a pose, whether or not it is due.
  [[nodiscard]] std::optional<protocol::Pose> newest() const;
  /// When next() will have one; nullopt when nothing waits.
  [[nodiscard]] std::optional<std::uint64_t> dueAtMs() const;

  /// Id of the newest view, sent or not; 0: there is none. What a server settles for an older id
  /// does not count.
  [[nodiscard]] std::uint32_t newestId() const { return newestId_; }

 private:
  std::uint8_t channel_;
  std::optional<ClientView> view_;
  bool waiting_ = false;
  std::uint32_t newestId_ = 0;
  std::uint64_t earliestMs_ = 0;
};

}  // namespace limn
