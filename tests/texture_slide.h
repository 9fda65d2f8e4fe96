// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/parameters.h"
#include "client/stroke/spine.h"

#include "shared/core/camera.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace limn {

/// What a frame leaves behind, to be compared with the next.
struct StrokeFrame {
  Camera camera;
  SpineSet spines;
  SpineParameters parameters;
};

/// The parameter of a frame's line within 2 px of a place in the picture, at about its depth.
inline std::optional<float>
parameterBeside(const StrokeFrame& frame, const glm::vec2& p, float depth) {
  float best = 2.0F;
  std::optional<float> parameter;
  for (const SpineSet::Spine& spine : frame.spines.spines) {
    for (std::uint32_t i = spine.begin; i + 1 < spine.end; ++i) {
      const glm::vec2 a = frame.spines.exact[i];
      if (std::abs(frame.spines.depth[i] - depth) > 0.02F) continue;
      const glm::vec2 ab = frame.spines.exact[i + 1] - a;
      const float t = std::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0F, 1.0F);
      const float distance = glm::distance(p, a + t * ab);
      if (distance >= best) continue;
      best = distance;
      parameter = glm::mix(frame.parameters.from[i], frame.parameters.to[i], t);
    }
  }
  return parameter;
}

/// Pixels by which the texture moved along the lines from one frame to the next, at every seventh
/// point of `before` that has a line of `after` beside it: against the model itself.
inline std::vector<float> textureSlides(
    const StrokeFrame& before,
    const StrokeFrame& after,
    const Viewport& viewport,
    float periodPx) {
  const glm::dmat4 clipFromWorld = after.camera.clipFromWorld(viewport.aspect());
  const glm::dmat4 worldFromClip = glm::inverse(before.camera.clipFromWorld(viewport.aspect()));
  std::vector<float> result;
  for (const SpineSet::Spine& spine : before.spines.spines) {
    for (std::uint32_t i = spine.begin; i < spine.end; i += 7) {
      const glm::vec2 p = before.spines.exact[i];
      const glm::dvec4 world = worldFromClip * glm::dvec4(
                                                   2.0 * p.x / viewport.width - 1.0,
                                                   1.0 - 2.0 * p.y / viewport.height,
                                                   2.0 * before.spines.depth[i] - 1.0,
                                                   1.0);
      const glm::dvec3 there =
          pixelFromClip(clipFromWorld * glm::dvec4(glm::dvec3(world) / world.w, 1.0), viewport);
      const auto found = parameterBeside(after, glm::vec2(there), static_cast<float>(there.z));
      if (!found) continue;
      const float change = *found - before.parameters.from[i];
      result.push_back(std::abs(change - periodPx * std::round(change / periodPx)));
    }
  }
  return result;
}

}  // namespace limn
