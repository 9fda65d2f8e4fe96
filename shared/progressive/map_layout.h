// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cmath>
#include <cstdint>

namespace limn {

/// Largest value of a channel in a map of colours, for sRGB 255: six bits, which linear
/// interpolation smoothes.
inline constexpr int kMapColorSteps = 63;

/// Where the faces of a hull level have their tiles in a map: right triangles, two in a square cell
/// (protocol/SPEC.md, "Hull maps"; [Sander00 §4]).
struct MapLayout {
  std::uint32_t faces = 0;
  int leg = 2;  // texels along a leg, ≥ 2

  static constexpr int kPadding = 1;

  [[nodiscard]] int cellSide() const { return leg + 2 * kPadding + 2; }

  [[nodiscard]] int cells() const { return static_cast<int>((faces + 1) / 2); }

  [[nodiscard]] int columns() const {
    return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(cells()))));
  }

  [[nodiscard]] int width() const { return columns() * cellSide(); }

  [[nodiscard]] int height() const { return (cells() + columns() - 1) / columns() * cellSide(); }

  /// Of a face's cell: its left, top texel.
  [[nodiscard]] glm::ivec2 cellOf(std::uint32_t face) const {
    const int cell = static_cast<int>(face / 2);
    return cellSide() * glm::ivec2(cell % columns(), cell / columns());
  }

  /// Where corner 0, 1 or 2 of a face lies, in texels from the left, top of the map; the middle of
  /// a texel is at halves.
  [[nodiscard]] glm::vec2 corner(std::uint32_t face, int corner) const {
    glm::vec2 place(static_cast<float>(kPadding) + 0.5F);
    if (corner > 0) place[corner - 1] += static_cast<float>(leg - 1);
    if (face % 2 == 1) place = glm::vec2(static_cast<float>(cellSide())) - place;
    return glm::vec2(cellOf(face)) + place;
  }
};

}  // namespace limn
