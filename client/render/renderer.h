// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/render/gl_context.h"
#include "client/render/image.h"
#include "client/stroke/brush.h"
#include "client/stroke/depth_image.h"
#include "client/stroke/polyline.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"

#include <glm/glm.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace limn {

enum class DrawMode {
  kStrokes,  // stylised lines on paper
  kShaded,   // the mesh, lit; no lines
};

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
  Brush brush;                // leads strokes off their lines
  HiddenLines hidden = HiddenLines::kStyle;
  std::optional<glm::vec3> paper;  // background, sRGB 0 … 1; the style's own when unset
  int supersample = 2;             // lines are drawn this many times larger and reduced; 1 to 4
  bool keepDepth = false;          // also return the depth image (for segmentVisibility)
};

/// Wall-clock milliseconds of one frame, each pass finished before the next is timed.
struct FrameTimings {
  double uploadMs = 0.0;      // mesh to the GPU, only when it has changed
  double strokeMs = 0.0;      // tessellation of lines into strips
  double visibilityMs = 0.0;  // depth pass and visibility along the lines
  double drawMs = 0.0;        // strokes, composition, read-back
};

struct Frame {
  Image image;
  FrameTimings timings;
  DepthImage depth;  // empty unless RenderOptions::keepDepth
};

struct GlDescription {
  std::string renderer;  // GL_RENDERER
  std::string version;   // GL_VERSION
};

/// Draws meshes and their lines. Owns its context and everything on the GPU; the mesh of the last
/// snapshot stays there until a snapshot of another asset or revision comes.
/// Threads: made, used and destroyed on one thread.
class Renderer {
 public:
  /// assets: the folder of texture sets, see findAssets(). Compiles every shader.
  /// Errors: kUnavailable (the context lacks something, or a shader does not compile).
  [[nodiscard]] static Result<Renderer> create(
      std::unique_ptr<GlContext> context,
      std::filesystem::path assets);

  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// lines: chained lines of snapshot.mesh, in its grid units; halfEdges and faces index its mesh.
  /// Errors: kInvalidArgument (size, supersample, unknown style), kLimitExceeded (picture larger
  /// than the GPU allows), kCorrupt (a damaged texture set).
  /// Cost: O(vertices + faces + pixels + length of the lines in pixels).
  [[nodiscard]] Result<Frame> render(
      const MeshSnapshot& snapshot,
      const PolylineSet& lines,
      const Camera& camera,
      const RenderOptions& options);

  [[nodiscard]] const GlDescription& gl() const;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace limn
