// SPDX-License-Identifier: Apache-2.0
// Based on: papers/002, section 3.5 (parameterised brush functions).
// Deviations: rand() is a hash of place and seed, so that frames agree; functions are periodic.
#include "client/stroke/brush.h"

#include <cmath>
#include <string>

namespace limn {
namespace {

/// −1 … 1.
float noiseAt(std::uint32_t place, std::uint32_t seed) {
  std::uint32_t h = place * 0x9e3779b9U + seed * 0x85ebca6bU;
  h ^= h >> 16U;
  h *= 0x7feb352dU;
  h ^= h >> 15U;
  h *= 0x846ca68bU;
  h ^= h >> 16U;
  return static_cast<float>(h >> 8U) / 8388608.0F - 1.0F;
}

/// Where in its waves a parameter is.
struct Phase {
  std::uint32_t wave = 0;
  std::uint32_t next = 0;  // the wave after, round the period
  float t = 0.0F;          // 0 … 1 within the wave
};

Phase phaseOf(float parameter, float period, std::uint32_t waves) {
  const float turns = parameter / period;
  const float place = (turns - std::floor(turns)) * static_cast<float>(waves);
  Phase phase;
  phase.wave = static_cast<std::uint32_t>(place) % waves;
  phase.next = (phase.wave + 1) % waves;
  phase.t = place - std::floor(place);
  return phase;
}

float smoothNoise(const Phase& phase, std::uint32_t seed) {
  const float t = phase.t * phase.t * (3.0F - 2.0F * phase.t);
  return glm::mix(noiseAt(phase.wave, seed), noiseAt(phase.next, seed), t);
}

}  // namespace

Brush usualBrush(BrushKind kind) {
  switch (kind) {
    case BrushKind::kPlain:
      break;
    case BrushKind::kCharcoal:
      return {kind, 1.6F, 5.0F, 1};
    case BrushKind::kLazy:
      return {kind, 3.5F, 56.0F, 1};
    case BrushKind::kHand:
      return {kind, 1.4F, 18.0F, 1};
    case BrushKind::kRough:
      return {kind, 11.0F, 26.0F, 1};
  }
  return {};
}

Result<BrushKind> parseBrushKind(std::string_view name) {
  if (name == "none") return BrushKind::kPlain;
  if (name == "charcoal") return BrushKind::kCharcoal;
  if (name == "lazy") return BrushKind::kLazy;
  if (name == "hand") return BrushKind::kHand;
  if (name == "rough") return BrushKind::kRough;
  return fail(
      ErrorCode::kInvalidArgument,
      "there is no brush '" + std::string(name) + "': use none, charcoal, lazy, hand or rough");
}

glm::vec2 brushOffset(const Brush& brush, float parameterPx, float periodPx) {
  if (brush.kind == BrushKind::kPlain || !(brush.amplitudePx > 0.0F)) return glm::vec2(0.0F);
  const float count = std::round(periodPx / std::max(brush.wavelengthPx, 0.5F));
  auto waves = static_cast<std::uint32_t>(std::max(1.0F, count));
  switch (brush.kind) {
    case BrushKind::kPlain:
      break;
    case BrushKind::kCharcoal: {
      const Phase phase = phaseOf(parameterPx, periodPx, waves);
      // Slowly to one side, at once back; no two teeth are alike.
      constexpr float kRise = 0.8F;
      const float tooth = phase.t < kRise ? phase.t / kRise : (1.0F - phase.t) / (1.0F - kRise);
      const float size = 0.7F + 0.3F * noiseAt(phase.wave, brush.seed);
      return {0.0F, brush.amplitudePx * size * (2.0F * tooth - 1.0F)};
    }
    case BrushKind::kLazy: {
      waves += waves % 2;  // to one side, then to the other
      const Phase phase = phaseOf(parameterPx, periodPx, waves);
      const float arch = 4.0F * phase.t * (1.0F - phase.t);
      const float size = 0.75F + 0.25F * noiseAt(phase.wave, brush.seed);
      return {0.0F, brush.amplitudePx * size * (phase.wave % 2 == 0 ? arch : -arch)};
    }
    case BrushKind::kHand: {
      const Phase phase = phaseOf(parameterPx, periodPx, waves);
      return {
          brush.amplitudePx * smoothNoise(phase, brush.seed),
          brush.amplitudePx * smoothNoise(phase, brush.seed + 101U)};
    }
    case BrushKind::kRough: {
      const Phase phase = phaseOf(parameterPx, periodPx, waves);
      return {brush.amplitudePx * smoothNoise(phase, brush.seed), 0.0F};
    }
  }
  return glm::vec2(0.0F);
}

}  // namespace limn
