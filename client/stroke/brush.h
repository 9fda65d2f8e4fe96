// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/result.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <string_view>

namespace limn {

/// How a hand leads a stroke off its line: papers/002, table 1.
enum class BrushKind : std::uint8_t {
  kPlain,     // not at all
  kCharcoal,  // a high-frequency sawtooth across the line
  kLazy,      // low-frequency parabolas across it
  kHand,      // little noise, across and along
  kRough,     // much noise along: strokes overshoot and come back
};

/// A brush function: the stroke is drawn at q(t) = p(t) + v_x(t) p'(t) + v_y(t) n(t), where t is
/// the line's parameter, p' its tangent and n its normal.
struct Brush {
  BrushKind kind = BrushKind::kPlain;
  float amplitudePx = 0.0F;   // of the largest part of (v_x, v_y)
  float wavelengthPx = 1.0F;  // of the parameter
  std::uint32_t seed = 1;
};

/// A kind with its usual amplitude and wavelength.
[[nodiscard]] Brush usualBrush(BrushKind kind);

/// `none|charcoal|lazy|hand|rough`. Errors: kInvalidArgument, naming the choices.
[[nodiscard]] Result<BrushKind> parseBrushKind(std::string_view name);

/// (v_x, v_y) in pixels: along and across the line. A function of nothing but its arguments, so
/// that a stroke whose parameters stay put does not flicker. Periodic in periodPx, so that loops
/// close; the wavelength is fitted to it. Cost: O(1).
[[nodiscard]] glm::vec2 brushOffset(const Brush& brush, float parameterPx, float periodPx);

}  // namespace limn
