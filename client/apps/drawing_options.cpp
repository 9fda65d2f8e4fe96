// SPDX-License-Identifier: Apache-2.0
#include "client/apps/drawing_options.h"

#include "client/core/hull_streams.h"

#include <cstdio>

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

void noteMissingHull(const ModelDescription& model, const RenderCommandOptions& options) {
  if (options.draw != DrawMode::kClip || model.hasHull()) return;
  std::fprintf(
      stderr,
      "limn-client: %s; it is drawn whole, not clipped\n",
      whyNoHull(model).c_str());
}

Result<void> checkHull(const MeshSnapshot& snapshot, const RenderCommandOptions& options) {
  if (options.draw != DrawMode::kClip || snapshot.outerHull || !snapshot.model.hasHull()) return {};
  return fail(ErrorCode::kUnavailable, "the hull has not arrived: allow more");
}

}  // namespace limn
