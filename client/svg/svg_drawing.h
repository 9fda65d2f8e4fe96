// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/style.h"
#include "client/stroke/visibility/resolved_visibility.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace limn {

/// How one kind of line is drawn in a vector picture.
struct SvgPen {
  glm::vec3 color{0.0F};  // sRGB 0 … 1
  float opacity = 1.0F;
  float widthPx = 2.5F;  // of silhouettes and borders; creases and seams by the style's creaseWidth
  std::vector<float> dashPx;  // ink and gap in turn, at the drawing's width; empty: solid
  float dashStartPx = 0.0F;   // of the first of them, from where the picture's texture begins
};

struct SvgOptions {
  std::string model;    // its name, for the file's title
  std::string creator;  // program and version
  SvgPen visible;
  std::optional<SvgPen> hidden;  // unset: hidden lines are left out
  bool hiddenAsVisible = false;  // hidden lines crowd and fade as visible ones do
  float widthFalloff = 0.0F;     // of both pens: StrokeBuildOptions has it
  float inkPx = 2.5F;            // an ordinary stroke's width in the picture: what lines crowd by
  float periodPx = 1.0F;         // of the picture's textures: dashes lie where its own do
};

/// The visibility of lines of which those segments are drawn, one entry a point
/// (VisibilityResolver).
using ResolveDrawn = std::function<ResolvedLines(std::span<const std::uint8_t> isDrawn)>;

/// Lines as an SVG document that a designer can go on with: a layer (as Inkscape has them) for each
/// kind of line and visibility, its look in the layer's own attributes, every stroke one path of
/// lines and smooth curves within a quarter of a pixel of the drawing's strokes, loops closed. The
/// view is in the metadata. lines: of the scene's mesh; resolve: asked once for their visibility in
/// the scene; style: what lines fade and how they are smoothed, as in the picture.
/// Threads: reentrant. Cost: O(points · log points + bridges · runs).
[[nodiscard]] std::string svgDrawing(
    const PolylineSet& lines,
    const ResolveDrawn& resolve,
    const LineScene& scene,
    const StrokeStyle& style,
    const SvgOptions& options);

}  // namespace limn
