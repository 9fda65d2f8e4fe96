// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/brush.h"
#include "client/stroke/style.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// How a frame is drawn: `--draw NAME`.
enum class DrawMode {
  kStrokes,     // stylised lines on paper
  kShaded,      // the mesh, lit; no lines
  kImageEdges,  // where depth or normals of the picture jump
  // Silhouette edges found by shaders from adjacency.
  kGeometryShader,    // a geometry shader's where GL has one, else as the next
  kConditionalLines,  // a vertex shader's
  // Image-precision silhouettes: back faces, changed so that they show around the front.
  kBackWireframe,  // their edges
  kBackTranslate,  // nearer by a fixed amount
  kBackZScale,     // nearer by a share of the distance
  kBackOffset,     // nearer by their slope
  kBackFatten,     // edges pushed outwards by the line's width
  kBackCharcoal,   // those and grazing front faces, in greys
  kClip,           // a hull, lit, cut to the silhouette [Sander00]
};

/// Every way to draw.
[[nodiscard]] std::vector<DrawMode> allDrawModes();
/// Errors: kInvalidArgument, naming the choices.
[[nodiscard]] Result<DrawMode> parseDrawMode(std::string_view name);
/// As parseDrawMode() reads it.
[[nodiscard]] std::string_view nameOf(DrawMode mode);
/// Whether it draws lines that a detector found; the others find theirs on the GPU.
[[nodiscard]] bool needsLines(DrawMode mode);

/// How image-precision methods tell the front from the rest: `--first-layer auto|winding|numbers`.
enum class FirstLayer {
  kAuto,     // by winding where the model is closed
  kWinding,  // faces wound towards the eye are the front
  kNumbers,  // faces that some pixel shows are, however they are wound
};

/// Errors: kInvalidArgument, naming the choices.
[[nodiscard]] Result<FirstLayer> parseFirstLayer(std::string_view name);

/// What becomes of the hidden parts of lines: `--hidden style|off|as-visible`.
enum class HiddenLines { kStyle, kOff, kAsVisible };

/// Errors: kInvalidArgument, naming the choices.
[[nodiscard]] Result<HiddenLines> parseHiddenLines(std::string_view name);

struct RenderOptions {
  Viewport viewport;
  DrawMode draw = DrawMode::kStrokes;
  std::string style = "pencil";           // a texture set: client/assets/NAME/style.toml
  std::optional<double> widthPx;          // stroke width; the style's own when unset
  std::optional<double> widthModelUnits;  // instead: goes with distance as the model does
  double widthFalloff = 0.0;  // of a width in pixels: 0 the same everywhere, 1 as the model
  double textureSize = 1.0;   // times as long as the style has a texture's repeats
  Brush brush;                // leads strokes off their lines
  HiddenLines hidden = HiddenLines::kStyle;
  std::optional<glm::vec3> lineColor;  // sRGB 0 … 1; the style's own when unset. Not of strokes
  std::optional<glm::dvec3> light;  // a place in model coordinates; silhouettes that shaders find
                                    // are those it sees, shaded meshes are lit from there
  double lineFade = 0.0;  // share of their darkness lines lose at the far end. Not of strokes
  FirstLayer firstLayer = FirstLayer::kAuto;
  std::optional<glm::vec3> paper;  // background, sRGB 0 … 1; the style's own when unset
  std::uint32_t hullFaces = 500;   // kClip: of the outer hull, or as near from below
  /// Pixels of this picture for each one that widths, brushes and styles count in: below 1 for a
  /// coarse one that is shown enlarged.
  double pixelScale = 1.0;
  int supersample = 2;     // lines are drawn this many times larger and reduced; 1 to 4
  bool keepDepth = false;  // also return the depth image (for segmentVisibility)
};

/// Of a line at the camera's target, pixels of the picture; style: for a width that is unset.
[[nodiscard]] float
lineWidthPx(const RenderOptions& options, const StrokeStyle& style, const Camera& camera);

/// Widths go with distance to the power of −this.
[[nodiscard]] float lineWidthFalloff(const RenderOptions& options);

/// Wall-clock milliseconds of one frame, each pass finished before the next is timed.
struct FrameTimings {
  double uploadMs = 0.0;      // mesh to the GPU, only when it has changed
  double strokeMs = 0.0;      // tessellation of lines into strips
  double visibilityMs = 0.0;  // depth pass and visibility along the lines
  double drawMs = 0.0;        // all other drawing, read-back
};

}  // namespace limn
