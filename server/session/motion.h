// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "protocol/messages.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace limn {

/// Where a moving camera will be: its last poses taken as one steady rigid motion, a screw
/// (circling around anything, flying straight, turning on the spot), which goes on.
class Motion {
 public:
  /// A pose and when it came. Clears what was known when it came after a pause.
  void add(const protocol::Pose& pose, std::int64_t nowMs);

  void clear() { count_ = 0; }

  /// The newest pose, moved on by aheadMs; nullopt while the camera stands still or too little is
  /// known.
  [[nodiscard]] std::optional<protocol::Pose> at(std::int64_t aheadMs) const;

 private:
  static constexpr std::size_t kSamples = 4;

  struct Sample {
    glm::dvec3 eye{0.0};
    glm::dmat3 frame{1.0};  // columns right, up, backward
    std::int64_t atMs = 0;
  };

  protocol::Pose newest_;
  std::array<Sample, kSamples> samples_{};  // oldest first
  std::size_t count_ = 0;
};

}  // namespace limn
