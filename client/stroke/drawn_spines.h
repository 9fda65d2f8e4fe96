// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/stroke/chain/polyline.h"
#include "client/stroke/line_fade.h"
#include "client/stroke/line_scene.h"
#include "client/stroke/spine.h"
#include "client/stroke/style.h"

#include <vector>

namespace limn {

/// What is drawn of a view's lines, and where strokes run: in pictures and in drawings (SVG) alike.
/// Keeps its memory from frame to frame. Threads: one caller at a time.
struct DrawnSpines {
  SpineSet spines;
  std::vector<LineFade> fades;  // parallel to spines.spines

  /// Lines to spines: projected, too small ones left out, swallowtails cut (cutFoldBacks), joined
  /// over short gaps (bridgeCusps); not smoothed. widthPx: of the ink. Fills all of it anew.
  /// Cost: O(points + spines · log spines).
  void
  find(const PolylineSet& lines, const LineScene& scene, const StrokeStyle& style, float widthPx);

 private:
  SpineProjector projector_;
};

}  // namespace limn
