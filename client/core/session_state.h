// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/byte_counters.h"
#include "client/core/snapshot.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace limn {

/// How much of a model a client holds, for its newest pose. Each includes those before it.
enum class MeshState : std::uint8_t {
  kNothing,   // not even the base mesh
  kBase,      // the base mesh and no split
  kPartial,   // some splits
  kSettled,   // every visible silhouette within the error bound (the server says so)
  kExact,     // every silhouette edge's faces present (the server says so)
  kComplete,  // every split
};

[[nodiscard]] std::string_view nameOf(MeshState state);

/// When a session has what it was started for.
struct StopCondition {
  enum class Kind : std::uint8_t { kState, kBytes, kSeconds, kNever };
  Kind kind = Kind::kState;
  MeshState state = MeshState::kSettled;  // kState: this one or a later one
  std::uint64_t bytes = 0;                // kBytes: what has wholly arrived within that many
  double seconds = 0.0;                   // kSeconds: since start
};

/// When each state was first reached, in milliseconds since the session's start.
struct StateTimes {
  std::optional<double> connectMs;
  std::optional<double> baseMs;
  std::optional<double> settledMs;
  std::optional<double> exactMs;
  std::optional<double> completeMs;
};

/// What exact contours have taken.
struct ContourTimes {
  std::vector<double> answerMs;  // from each request to its decoded answer
  std::uint64_t points = 0;      // of all answers
};

/// What a session has come to.
struct SessionOutcome {
  std::shared_ptr<const MeshSnapshot> snapshot;                // of the first model
  std::vector<std::shared_ptr<const MeshSnapshot>> snapshots;  // by model
  MeshState state = MeshState::kNothing;
  ByteCounters bytes;
  StateTimes times;
  std::uint32_t reconnects = 0;
  ContourTimes contours = {};
};

}  // namespace limn
