// SPDX-License-Identifier: Apache-2.0
#include "client/render/drawing_method.h"

#include "client/render/back_faces_method.h"
#include "client/render/clip_method.h"
#include "client/render/edge_lines_method.h"
#include "client/render/image_edges_method.h"
#include "client/render/shaded_method.h"
#include "client/render/strokes_method.h"

namespace limn {

float DrawRequest::lineWidthPx() const {
  return limn::lineWidthPx(options, style.style, camera);
}

Result<std::unique_ptr<DrawingMethod>> makeDrawingMethod(DrawMode mode, DrawTools& tools) {
  switch (mode) {
    case DrawMode::kStrokes:
      return StrokesMethod::create(tools);
    case DrawMode::kShaded:
      return ShadedMethod::create(tools);
    case DrawMode::kImageEdges:
      return ImageEdgesMethod::create(tools);
    case DrawMode::kGeometryShader:
    case DrawMode::kConditionalLines:
      return EdgeLinesMethod::create(mode, tools);
    case DrawMode::kBackWireframe:
    case DrawMode::kBackTranslate:
    case DrawMode::kBackZScale:
    case DrawMode::kBackOffset:
    case DrawMode::kBackFatten:
    case DrawMode::kBackCharcoal:
      return BackFacesMethod::create(mode, tools);
    case DrawMode::kClip:
      return ClipMethod::create(tools);
  }
  return fail(ErrorCode::kUnsupported, "this way to draw is not in this release");
}

}  // namespace limn
