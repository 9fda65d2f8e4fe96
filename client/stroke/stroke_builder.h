// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/coherent_parameters.h"
#include "client/stroke/drawn_spines.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/nested_contours.h"
#include "client/stroke/parameters.h"
#include "client/stroke/spine.h"
#include "client/stroke/style.h"
#include "client/stroke/tessellate.h"
#include "client/stroke/visibility/line_spans.h"
#include "client/stroke/visibility/spine_samples.h"

#include <cstdint>
#include <vector>

namespace limn {

struct StrokeBuildOptions {
  float widthPx = 2.5F;  // of the ink; with falloff: at the camera's target
  float widthFalloff =
      0.0F;  // width goes with distance to the power of −this: 0 never, 1 as the model
  Brush brush{};
  SampleOptions samples{};
};

/// The pixels that a width in model units takes at the camera's target.
[[nodiscard]] float
widthInPixels(double modelUnits, const Camera& camera, const Viewport& viewport);

/// How many times as wide as at the camera's target a stroke is at a window depth, where widths go
/// with distance to the power of −falloff; 1 for falloff 0 and for orthographic cameras.
[[nodiscard]] float widthFactor(const Camera& camera, float depth, float falloff);

/// What a frame's lines become for the GPU: strips, and the samples that say where they are hidden.
struct BuiltStrokes {
  const SpineSamples& samples;
  const StrokeMesh& mesh;
  const SpineSet& spines;
  const SpineParameters& parameters;
};

/// Chained lines to strokes: what is drawn of them, smoothing, spans, samples, parameters and
/// strips, one after another. Parameters follow the frame before, so one builder draws one view's
/// frames. Keeps its memory from frame to frame, so that a frame allocates little once it is warm.
/// Threads: one caller at a time.
class StrokeBuilder {
 public:
  /// The result stays valid until the next call. Cost: O(faces + points + length in pixels).
  [[nodiscard]] BuiltStrokes build(
      const PolylineSet& lines,
      const LineScene& scene,
      const StrokeStyle& style,
      const StrokeBuildOptions& options);

 private:
  void findWidths(const PolylineSet& lines, const Camera& camera, float falloff);

  DrawnSpines drawn_;
  SpineArcs arcs_;
  LineSpanFinder spanFinder_;
  std::vector<std::uint8_t> isDrawn_;  // by point
  LineSpans spans_;
  SpineSamples samples_;
  NestedContours nested_;
  SpineParameters parameters_;
  std::vector<float> widths_;
  CoherentParameters coherence_;
  StrokeMesh mesh_;
};

}  // namespace limn
