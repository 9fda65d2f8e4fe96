// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"

#include "shared/codec/contour_codec.h"
#include "shared/core/camera.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace limn {

/// Closed silhouettes on the screen: triangles that span each loop, for winding numbers in the
/// stencil buffer, and its edges, for coverage.
struct ClipContours {
  /// xy: pixels from the bottom left, on the rasteriser's grid, at odd places: so the stencil's
  /// edges are exactly these, and none that is upright or level meets the middle of a pixel. Loop
  /// by loop, the first point repeated at the end; z: 1 where an edge leads to the next point, 0 at
  /// the end of a loop.
  std::vector<glm::vec3> points;
  /// Of points. Together a loop's triangles have its border, so they cover any pixel as often,
  /// counter-clockwise less clockwise, as the loop winds around it.
  std::vector<std::uint32_t> triangles;
};

struct ClipScreen {
  glm::dmat4 clipFromGrid{1.0};
  Viewport viewport;
  int subpixelBits = 8;  // GL_SUBPIXEL_BITS
};

/// Of lines, those that are silhouettes, grid units. An open one is closed by a straight edge.
/// nullopt: a point is not in front of the camera.
[[nodiscard]] std::optional<ClipContours> clipContoursOf(
    const PolylineSet& lines,
    const ClipScreen& screen);
/// The same of the server's.
[[nodiscard]] std::optional<ClipContours> clipContoursOf(
    const ContourLines& lines,
    const ClipScreen& screen);

/// Whether all points lie strictly on one side of some plane through `eye`, so that the eye is
/// outside their convex hull. False also where that is too close to tell.
/// Cost: O(points) as a rule.
[[nodiscard]] bool isOutsideConvexHull(const glm::dvec3& eye, std::span<const glm::dvec3> points);

}  // namespace limn
