// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"
#include "client/render/draw_options.h"
#include "client/render/draw_tools.h"
#include "client/render/style_store.h"
#include "client/stroke/chain/polyline.h"

#include "shared/core/camera.h"
#include "shared/core/result.h"
#include "shared/gl/target.h"

#include <glm/glm.hpp>

#include <memory>

namespace limn {

/// What one frame is drawn from. The mesh of `snapshot` is already on the GPU (DrawTools::mesh()).
struct DrawRequest {
  const MeshSnapshot& snapshot;
  const PolylineSet& lines;  // empty unless needsLines(options.draw)
  const Camera& camera;
  const RenderOptions& options;  // checked: size, supersample, width
  const LoadedStyle& style;
  glm::vec3 paper{1.0F};  // sRGB 0 … 1
  int supersample = 1;    // what the picture's size allows of options.supersample

  [[nodiscard]] gl::TextureSize fineSize() const {
    return {options.viewport.width * supersample, options.viewport.height * supersample};
  }

  /// Of a line at the model's centre, pixels of the picture.
  [[nodiscard]] float lineWidthPx() const;
};

/// One way to draw a frame: its shaders and targets, kept from frame to frame. Made by
/// makeDrawingMethod() when it is first asked for.
/// Threads: made, used and destroyed on the renderer's, with its context current.
class DrawingMethod {
 public:
  virtual ~DrawingMethod() = default;
  DrawingMethod(const DrawingMethod&) = delete;
  DrawingMethod& operator=(const DrawingMethod&) = delete;

  /// Fills `picture` (kRgba8, the viewport's size; for kClip, and kShaded without
  /// supersampling, with depth and stencil). A method sets
  /// timings.strokeMs and visibilityMs if it has such parts; the caller reads the picture back and
  /// calls the rest drawMs. Blending, culling, depth and stencil tests are off before and after;
  /// writing colour and depth is on; any target, program or texture may be bound.
  [[nodiscard]] virtual Result<void>
  draw(const DrawRequest& request, const gl::Target& picture, FrameTimings& timings) = 0;

 protected:
  DrawingMethod() = default;
};

/// tools outlives the method. Errors: kUnavailable (a shader that this GL does not compile).
[[nodiscard]] Result<std::unique_ptr<DrawingMethod>> makeDrawingMethod(
    DrawMode mode,
    DrawTools& tools);

}  // namespace limn
