// SPDX-License-Identifier: Apache-2.0
#include "client/apps/drawing_options.h"

namespace limn {

protocol::Silhouette wantedSilhouette(const RenderCommandOptions& options) {
  return options.silhouette == SilhouetteKind::kEdges ? protocol::Silhouette::kEdges
                                                      : protocol::Silhouette::kSmooth;
}

LineFinderOptions lineOptionsOf(const RenderCommandOptions& options) {
  return {
      options.detector,
      options.silhouette,
      options.features,
      options.light,
      options.detectorParameters};
}

RenderOptions renderOptionsOf(const RenderCommandOptions& options) {
  RenderOptions render;
  render.viewport = options.viewport;
  render.draw = options.draw;
  render.style = options.style;
  render.widthPx = options.widthPx;
  render.widthModelUnits = options.widthModelUnits;
  render.widthFalloff = options.widthFalloff;
  render.textureSize = options.textureSize;
  render.brush = options.brush;
  render.hidden = options.hidden;
  render.lineColor = options.lineColor;
  render.lineFade = options.lineFade;
  render.light = options.light;
  render.firstLayer = options.firstLayer;
  render.hullFaces = options.hullFaces;
  return render;
}

}  // namespace limn
