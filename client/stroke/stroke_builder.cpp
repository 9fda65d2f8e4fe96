// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/stroke_builder.h"

#include "client/stroke/view_distance.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// Strokes grow and shrink with distance by no more than this.
constexpr float kLargestGrowth = 4.0F;

}  // namespace

float widthInPixels(double modelUnits, const Camera& camera, const Viewport& viewport) {
  const double distance = glm::distance(camera.eye, camera.target);
  return static_cast<float>(modelUnits * pixelsPerUnit(camera, viewport, distance));
}

float widthFactor(const Camera& camera, float depth, float falloff) {
  if (!(falloff > 0.0F) || camera.orthographic) return 1.0F;
  const auto reference = static_cast<float>(glm::distance(camera.eye, camera.target));
  const float nearness = reference / std::max(viewDistance(camera, depth), 1e-9F);
  return std::clamp(std::pow(nearness, falloff), 1.0F / kLargestGrowth, kLargestGrowth);
}

BuiltStrokes StrokeBuilder::build(
    const PolylineSet& lines,
    const LineScene& scene,
    const StrokeStyle& style,
    const StrokeBuildOptions& options) {
  drawn_.find(lines, scene, style, options.widthPx);
  SpineSet& spines = drawn_.spines;
  smoothSpines(style.smoothPx, spines);
  measureSpines(spines, arcs_);
  markDrawn(spines, lines.points.size(), isDrawn_);
  spanFinder_.find(lines, isDrawn_, scene, spans_);
  sampleSpines(spines, arcs_, spans_, scene.viewport, options.samples, samples_);
  nested_.find(scene.viewport, options.widthPx, drawn_.fades, samples_);
  const float period = texturePeriod(style, options.widthPx);
  coherence_.assign(spines, arcs_, lines, scene, period, parameters_);
  findWidths(lines, scene.camera, options.widthFalloff);
  tessellate(
      {spines, arcs_, drawn_.fades, samples_, parameters_, widths_},
      style,
      options.widthPx,
      options.brush,
      mesh_);
  return {samples_, mesh_, spines, parameters_};
}

void StrokeBuilder::findWidths(const PolylineSet& lines, const Camera& camera, float falloff) {
  widths_.clear();
  const bool falls = falloff > 0.0F && !camera.orthographic;
  if (!falls && lines.strengths.empty()) return;
  const SpineSet& spines = drawn_.spines;
  widths_.assign(spines.points.size(), 1.0F);
  if (falls) {
    for (std::size_t i = 0; i < widths_.size(); ++i)
      widths_[i] = widthFactor(camera, spines.depth[i], falloff);
  }
  if (lines.strengths.empty()) return;
  for (std::size_t i = 0; i < widths_.size(); ++i)
    widths_[i] *= lines.strengths[spines.source[i]];
}

}  // namespace limn
