// SPDX-License-Identifier: Apache-2.0
#include "client/stroke/stroke_builder.h"

namespace limn {

BuiltStrokes StrokeBuilder::build(
    const PolylineSet& lines,
    const LineScene& scene,
    const StrokeStyle& style,
    const StrokeBuildOptions& options) {
  projector_.project(lines, scene, options.mergePx, spines_);
  fadeLines(spines_, style, fades_);
  dropFaded(spines_, fades_);
  smoothSpines(style.smoothPx, spines_);
  measureSpines(spines_, arcs_);
  sampleSpines(spines_, arcs_, lines, scene, options.samples, samples_);
  const float period = texturePeriod(style, options.widthPx);
  coherence_.assign(spines_, arcs_, lines, scene, period, parameters_);
  tessellate({spines_, arcs_, fades_, samples_, parameters_}, style, options.widthPx, mesh_);
  return {samples_, mesh_, spines_, parameters_};
}

}  // namespace limn
