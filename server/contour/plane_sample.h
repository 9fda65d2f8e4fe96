// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace limn {

/// The planes of a cluster that decide about its cones, or most of them: a bounded sample, so that
/// predicting a join costs the same however large the clusters are.
struct PlaneSample {
  static constexpr std::size_t kMost = 16;

  std::array<glm::vec4, kMost> planes{};  // unit normal, offset; about the field's centre
  std::uint32_t count = 0;
  bool hasDegenerate = false;  // a plane without a normal is among those it stands for
  glm::vec3 center{0.0F};      // of the faces, their mean

  [[nodiscard]] std::span<const glm::vec4> all() const { return {planes.data(), count}; }
};

/// Two samples as one, and the share of eyes that its cones would not hold.
struct JoinedSample {
  PlaneSample sample;
  double missed = 1.0;
};

/// weights: how many faces each stands for. eyeRadius: eyes are uniform in a ball of that radius
/// about the model. Cost: O(1), half a microsecond.
[[nodiscard]] JoinedSample
join(const PlaneSample& a, const PlaneSample& b, const glm::vec2& weights, double eyeRadius);

/// The same without the new sample.
[[nodiscard]] double missedByJoin(
    const PlaneSample& a,
    const PlaneSample& b,
    const glm::vec2& weights,
    double eyeRadius);

}  // namespace limn
