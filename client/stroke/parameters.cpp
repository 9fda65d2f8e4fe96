// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/parameters.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace limn {
namespace {

/// Loops are stretched to whole periods by no more than this factor; a smaller one has a seam
/// instead, since a texture squeezed into it would be a blur, and its dashes dots.
constexpr float kMostStretch = 1.5F;

/// Where in the texture a line starts, 0 … 1: every line differently, the same one in every frame.
float startOf(const glm::vec3& p) {
  std::uint32_t hash = 2166136261U;
  for (const float value : {p.x, p.y, p.z}) {
    hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 16777619U;
    hash ^= hash >> 15U;
  }
  return static_cast<float>(hash >> 8U) / 16777216.0F;
}

}  // namespace

void freshParameters(
    const SpineSet& spines,
    const SpineArcs& arcs,
    const PolylineSet& lines,
    float periodPx,
    SpineParameters& out) {
  out.from.resize(spines.points.size());
  out.to.resize(spines.points.size());
  for (std::size_t index = 0; index < spines.spines.size(); ++index) {
    const SpineSet::Spine& spine = spines.spines[index];
    const float length = arcs.length[index];
    const float start = periodPx * startOf(lines.points[lines.lines[spine.line].begin]);
    float scale = 1.0F;
    if (spine.closed && length > 0.0F) {
      const float whole = std::max(1.0F, std::round(length / periodPx)) * periodPx / length;
      if (whole < kMostStretch) scale = whole;
    }
    for (std::uint32_t i = spine.begin; i < spine.end; ++i) {
      out.from[i] = start + scale * arcs.arc[i];
      if (i > spine.begin) out.to[i - 1] = out.from[i];
    }
    out.to[spine.end - 1] = start + scale * length;
  }
}

}  // namespace limn
